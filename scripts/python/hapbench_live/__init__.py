"""The live page: the engine and its scenes as one file."""
