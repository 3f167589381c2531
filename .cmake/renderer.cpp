// CMake wants a source of its own; the library's functions are in scenarios/renderer.
