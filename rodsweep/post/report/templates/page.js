"use strict";
// Shows the value of a figure that is nearest to the pointer. Without this script browsers show the titles.
(() => {
  const reach = 18;  // pixels on the screen
  const shown = document.getElementById("value");
  for (const svg of document.querySelectorAll(".picture svg")) {
    const values = [...svg.querySelectorAll(".values circle")].map((circle) => {
      const title = circle.querySelector("title");
      title.remove();  // or the browser would show it as well
      return { circle, text: title.textContent, x: +circle.getAttribute("cx"), y: +circle.getAttribute("cy") };
    });
    let near = null;
    const leave = () => {
      near?.circle.classList.remove("near");
      near = null;
      shown.hidden = true;
    };
    const point = (event) => {
      const matrix = svg.getScreenCTM();
      const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
      let least = reach / matrix.a;
      let found = null;
      for (const value of values) {
        const distance = Math.hypot(value.x - at.x, value.y - at.y);
        if (distance <= least) { least = distance; found = value; }
      }
      if (found !== near) {
        leave();
        near = found;
        near?.circle.classList.add("near");
      }
      if (!near) return;
      shown.textContent = near.text;
      shown.hidden = false;
      const right = event.clientX + 14 + shown.offsetWidth > innerWidth;
      const below = event.clientY + 14 + shown.offsetHeight > innerHeight;
      shown.style.left = `${right ? Math.max(0, event.clientX - 14 - shown.offsetWidth) : event.clientX + 14}px`;
      shown.style.top = `${below ? Math.max(0, event.clientY - 14 - shown.offsetHeight) : event.clientY + 14}px`;
    };
    svg.addEventListener("pointermove", point);
    svg.addEventListener("pointerdown", point);
    svg.addEventListener("pointerleave", leave);
  }
})();
