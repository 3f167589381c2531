// CMake requires a source file for this library; the functions of the library are in scenarios/renderer.
