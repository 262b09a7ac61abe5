// Animation of the arm: its limit cycle, its shape while the tip is dragged, its motion after the release.
// Each frame is drawn on a separate canvas: Bokeh would repaint the whole figure, which takes longer than a frame.
const view = Bokeh.index.find_one(figure)
const canvas = document.createElement("canvas")
canvas.className = "bk-layer"
let beats = shapes.data, bends = bent.data, moves = motion.data
let mode = "beats", since = 0
const nodes_of = (data) => data.number[0]
const count_of = (data) => data.number.length && data.x.length / nodes_of(data)
function draw_at(data, before, after, part) {
  const nodes = nodes_of(data), at = arm.data
  if (at.x.length !== nodes) { at.x = new Float64Array(nodes); at.y = new Float64Array(nodes) }
  for (let i = 0; i < nodes; i++) {
    at.x[i] = (1 - part) * data.x[before * nodes + i] + part * data.x[after * nodes + i]
    at.y[i] = (1 - part) * data.y[before * nodes + i] + part * data.y[after * nodes + i]
  }
  paint(at)
}
function paint({x, y}) {
  const {overlays} = view.canvas_view, {x_scale, y_scale, bbox} = view.frame
  if (!canvas.isConnected) overlays.canvas.after(canvas)
  if (canvas.width !== overlays.canvas.width) canvas.width = overlays.canvas.width
  if (canvas.height !== overlays.canvas.height) canvas.height = overlays.canvas.height
  const context = canvas.getContext("2d"), ratio = overlays.pixel_ratio
  context.setTransform(ratio, 0, 0, ratio, 0, 0)
  context.clearRect(0, 0, canvas.width, canvas.height)
  context.save()
  context.beginPath()
  context.rect(bbox.x, bbox.y, bbox.width, bbox.height)
  context.clip()
  context.beginPath()
  for (let i = 0; i < x.length; i++) context.lineTo(x_scale.compute(x[i]), y_scale.compute(y[i]))
  context.strokeStyle = colour
  context.lineWidth = 5
  context.lineCap = context.lineJoin = "round"
  context.stroke()
  context.restore()
}
function loop(data, phase) {
  const count = count_of(data)
  if (count === 0) return
  const place = (phase - Math.floor(phase)) * count, before = Math.floor(place) % count
  draw_at(data, before, (before + 1) % count, place - Math.floor(place))
}
// Phase of the cycle whose shape is nearest to the drawn shape of the arm.
function nearest_phase(data) {
  const nodes = nodes_of(data), count = count_of(data), at = arm.data
  let best = 0, least = Infinity
  for (let k = 0; k < count; k++) {
    let distance = 0
    for (let i = 0; i < nodes; i++)
      distance += (data.x[k * nodes + i] - at.x[i]) ** 2 + (data.y[k * nodes + i] - at.y[i]) ** 2
    if (distance < least) { least = distance; best = k }
  }
  return best / count
}
function notice(now) {
  if (bent.data !== bends) {
    bends = bent.data
    if (bends.x.length) mode = "bent"
    else if (mode === "bent") mode = "beats"
  }
  if (motion.data !== moves) {
    moves = motion.data
    if (moves.x.length) { mode = "moves"; since = now } else mode = "beats"
  }
  if (shapes.data !== beats) { beats = shapes.data; if (mode !== "bent") mode = "beats" }
}
function draw(now) {
  notice(now)
  const seconds = (now - since) / 1000
  if (mode === "beats") loop(beats, now / 1000 / period)
  else if (mode === "bent") draw_at({x: bends.x, y: bends.y, number: [bends.x.length]}, 0, 0, 0)
  else if (mode === "moves") {
    const place = seconds / motion.tags[0], last = count_of(moves) - 1
    if (place < last) draw_at(moves, Math.floor(place), Math.floor(place) + 1, place - Math.floor(place))
    else {
      draw_at(moves, last, last, 0)
      mode = reached.data.x.length ? "reached" : "rests"
      since = now - (mode === "reached" ? nearest_phase(reached.data) * motion.tags[1] * 1000 : 0)
    }
  } else if (mode === "reached") loop(reached.data, seconds / motion.tags[1])
  if (arm.tags[0] !== mode) arm.tags = [mode]
  requestAnimationFrame(draw)
}
requestAnimationFrame(draw)
