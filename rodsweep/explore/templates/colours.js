const dark = matchMedia("(prefers-color-scheme: dark)")
function paint() {
  const style = getComputedStyle(document.documentElement)
  const [page, ink, line] = ["--page", "--ink", "--line"].map((name) => style.getPropertyValue(name).trim())
  for (const figure of figures) {
    figure.background_fill_color = page
    figure.border_fill_color = page
    figure.outline_line_color = line
    figure.title.text_color = ink
    for (const axis of [...figure.below, ...figure.left]) {
      axis.axis_label_text_color = ink
      axis.major_label_text_color = ink
      axis.axis_line_color = ink
      axis.major_tick_line_color = ink
      axis.minor_tick_line_color = ink
    }
    for (const each of figure.center) {
      if ("grid_line_color" in each) each.grid_line_color = line
      if ("label_text_color" in each) {
        each.label_text_color = ink
        each.background_fill_color = page
        each.background_fill_alpha = 0.7
        each.border_line_color = null
      }
    }
  }
}
paint()
dark.addEventListener("change", paint)
