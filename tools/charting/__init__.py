"""Charts of experiments: a module a figure, and what they share (record, style, sheet, plot,
labels)."""
