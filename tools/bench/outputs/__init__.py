"""The parts of same_outputs.py: what is asked, with which inputs, and how the outputs are compared."""
