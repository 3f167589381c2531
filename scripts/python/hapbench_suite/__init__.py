"""`hapbench suite`: a frozen set of scenes, a law in, a judged row out that anyone can verify."""
