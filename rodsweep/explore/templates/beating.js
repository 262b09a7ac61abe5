// Animation of the arm: its limit cycle, its shape while the tip is dragged, its motion after the release.
// Each frame is drawn on a separate canvas: Bokeh would repaint the whole figure, which takes longer than a frame.
const view = Bokeh.index.find_one(figure)
const canvas = document.createElement("canvas")
canvas.className = "bk-layer"
let beats = shapes.data, bends = bent.data, moves = motion.data
let mode = "beats", since = 0
const nodes_of = (data) => data.number[0]
const count_of = (data) => data.number.length && data.x.length / nodes_of(data)
// Draws the weighted mean of the shapes with the given numbers.
function draw_mean(data, numbers, weights) {
  const nodes = nodes_of(data), at = arm.data
  if (at.x.length !== nodes) { at.x = new Float64Array(nodes); at.y = new Float64Array(nodes) }
  at.x.fill(0)
  at.y.fill(0)
  numbers.forEach((number, k) => {
    for (let i = 0; i < nodes; i++) {
      at.x[i] += weights[k] * data.x[number * nodes + i]
      at.y[i] += weights[k] * data.y[number * nodes + i]
    }
  })
  paint(at)
}
// Draws the shape after the fraction t of the time between two shapes: cubic polynomials through the neighbouring
// shapes, as in the drawn path of the tip (post/figures/cycle/tip_path.py). Linear interpolation would give the
// motion of the tip a kink at each shape.
function draw_between(data, before, t, is_closed) {
  const count = count_of(data), s = 1 - t, a = t * s * s / 2, b = t * t * s / 2
  const numbers = [before - 1, before, before + 1, before + 2]
  let weights = [-a, s * s * (1 + 2 * t) + b, t * t * (1 + 2 * s) + a, -b]
  if (is_closed) return draw_mean(data, numbers.map((number) => (number + count) % count), weights)
  if (count < 3) weights = [0, s, t, 0]
  else {
    if (before === 0) weights = [0, weights[1] - 3 * a, weights[2] + 3 * a, weights[3] - a]
    if (before + 2 === count) weights = [weights[0] - b, weights[1] + 3 * b, weights[2] - 3 * b, 0]
  }
  draw_mean(data, numbers.map((number) => Math.min(Math.max(number, 0), count - 1)), weights)
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
  const place = (phase - Math.floor(phase)) * count
  draw_between(data, Math.floor(place) % count, place - Math.floor(place), true)
}
// Phase of the cycle whose shape is nearest to the drawn shape of the arm; the squared distance is taken as a
// parabola through the nearest shape and its two neighbours.
function nearest_phase(data) {
  const nodes = nodes_of(data), count = count_of(data), at = arm.data
  const distances = new Float64Array(count)
  for (let k = 0; k < count; k++)
    for (let i = 0; i < nodes; i++)
      distances[k] += (data.x[k * nodes + i] - at.x[i]) ** 2 + (data.y[k * nodes + i] - at.y[i]) ** 2
  const best = distances.indexOf(Math.min(...distances))
  const [before, least, after] = [best + count - 1, best, best + 1].map((k) => distances[k % count])
  return (best + (before - after) / (2 * (before - 2 * least + after) || 1)) / count
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
  else if (mode === "bent") draw_mean({x: bends.x, y: bends.y, number: [bends.x.length]}, [0], [1])
  else if (mode === "moves") {
    const place = seconds / motion.tags[0], last = count_of(moves) - 1
    if (place < last) draw_between(moves, Math.floor(place), place - Math.floor(place), false)
    else {
      draw_mean(moves, [last], [1])
      mode = reached.data.x.length ? "reached" : "rests"
      since = now - (mode === "reached" ? nearest_phase(reached.data) * motion.tags[1] * 1000 : 0)
    }
  } else if (mode === "reached") loop(reached.data, seconds / motion.tags[1])
  if (arm.tags[0] !== mode) arm.tags = [mode]
  requestAnimationFrame(draw)
}
requestAnimationFrame(draw)
