# CMake toolchain for WebAssembly with Debian's clang, lld, libc++ and wasi-libc.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(CMAKE_CXX_COMPILER clang++-19)
set(CMAKE_CXX_COMPILER_TARGET wasm32-wasi)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_CXX_COMPILE_OPTIONS_PIC "")
# -fignore-exceptions: see runtime.cpp. -nostdinc++: CMakeLists.txt adds compat/ and then the library's headers.
set(CMAKE_CXX_FLAGS_INIT "-msimd128 -fignore-exceptions -ffunction-sections -fdata-sections -nostdinc++")
