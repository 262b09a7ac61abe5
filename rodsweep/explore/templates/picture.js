const figure = figures[choice.value]
if (figure.visible) {
  const layer = Bokeh.index.find_one(figure).export(type)
  layer.to_blob().then((blob) => download(blob, `${choice.value}.${type}`))
}
