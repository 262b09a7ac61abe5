const element = document.querySelector(`[data-root-id="${text.id}"]`)
// A page that is being left has no elements any more.
if (element) {
  element.innerHTML = text.text
  if ("is_stoppable" in text) {
    element.parentElement.classList.toggle("solving", text.text !== "")
    element.parentElement.classList.toggle("stoppable", text.is_stoppable)
    document.body.dataset.solving = text.kinds.join(" ")
  }
}
