"""What tools/picture.py reads, and the image of points that it draws into."""
