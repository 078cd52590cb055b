"""Trials of how sure `clearway run` is: scenes whose truth is known, scanned with errors."""
