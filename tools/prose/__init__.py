"""What tools/check_prose.py knows of Markdown, of help texts, of names and of terms."""
