"""A surface beside points on it: time against points missed."""

from charting import accuracy


def draw(record):
    where = "hall" if "hall" in record.names("scene") else record.parameters.get("env", "")
    return accuracy.draw(record, f"A surface beside points on it ({where})")
