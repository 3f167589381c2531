"""Generated parts of the manuals, and the commands and links in them."""
