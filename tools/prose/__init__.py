"""What tools/check_prose.py knows of Markdown and of help texts."""
