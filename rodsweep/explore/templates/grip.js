// Drag in the picture of the arm: the tip follows the pointer, and its position is sent to the server.
const is_free = figure.toolbar.gestures?.pan?.active == null
const due = phase !== "bent" || performance.now() - (grip.told ?? 0) > 30
if (is_free && due && Number.isFinite(cb_obj.x) && Number.isFinite(cb_obj.y)) {
  grip.told = performance.now()
  grip.data = {x: [cb_obj.x], y: [cb_obj.y], phase: [phase]}
}
