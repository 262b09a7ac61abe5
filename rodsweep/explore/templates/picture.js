// `animated`: a line that is drawn on a canvas of its own, of which Bokeh knows only while it exports.
const figure = figures[choice.value]
if (figure.visible) {
  animated.setv({visible: true}, {sync: false})
  animated.data_source.change.emit()
  const layer = Bokeh.index.find_one(figure).export(type)
  animated.setv({visible: false}, {sync: false})
  layer.to_blob().then((blob) => download(blob, `${choice.value}.${type}`))
}
