// CMake requires a source file for the shared library hapbench_renderer; its functions are in scenarios/renderer.
