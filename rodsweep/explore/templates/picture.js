// `animated`: line that is drawn on a separate canvas; Bokeh draws this line only during an export.
const figure = figures[choice.value]
if (figure.visible) {
  animated.setv({visible: true}, {sync: false})
  animated.data_source.change.emit()
  const layer = Bokeh.index.find_one(figure).export(type)
  animated.setv({visible: false}, {sync: false})
  layer.to_blob().then((blob) => download(blob, `${choice.value}.${type}`))
}
