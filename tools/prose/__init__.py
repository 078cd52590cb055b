"""What tools/check_prose.py knows of Markdown, of help texts, of codes and of terms."""
