"""Charts of `clearway-bench`: a module a figure, and what they share (record, style, sheet, plot,
labels)."""
