# Builds libhapbench_renderer.so, which exports the functions of hapbench_renderer.h and contains the static libraries
# that they need.
file(STRINGS device_model/live/hapbench_renderer.h interface REGEX "define HAPBENCH_RENDERER_VERSION")
string(REGEX MATCH "[0-9]+" interface "${interface}")
add_library(hapbench_renderer SHARED ${CMAKE_CURRENT_LIST_DIR}/renderer.cpp)
add_library(hapbench::renderer ALIAS hapbench_renderer)
set_target_properties(hapbench_renderer PROPERTIES
  EXPORT_NAME renderer
  LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib
  VERSION ${PROJECT_VERSION}
  SOVERSION ${interface}
  LINK_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/renderer.map)
target_include_directories(hapbench_renderer INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/device_model/live> $<INSTALL_INTERFACE:include>)
# -Xlinker for the path, because -Wl, would split the path at its commas.
target_link_options(hapbench_renderer PRIVATE
  "SHELL:-Xlinker \"--version-script=${CMAKE_CURRENT_LIST_DIR}/renderer.map\""
  -Wl,--as-needed -Wl,--no-undefined)
target_link_libraries(hapbench_renderer
  PRIVATE $<LINK_LIBRARY:WHOLE_ARCHIVE,hapbench_scenarios_renderer> hapbench_flags)
