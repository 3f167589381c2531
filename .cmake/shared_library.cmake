# libhapbench.so, once for each level: in lib for HAPBENCH_ISA, in lib/glibc-hwcaps/LEVEL for the others. All have one name,
# and the dynamic loader (glibc 2.33) takes the highest level that the machine has, in whatever folder it looks.
include(GNUInstallDirs)
get_property(headers GLOBAL PROPERTY HAPBENCH_HEADER_TARGETS)
foreach(level "" ${HAPBENCH_LEVELS})
  set(target hapbench)
  set(folder ${PROJECT_BINARY_DIR}/lib)
  set(suffix "")
  if(level)
    set(target hapbench_${level})
    string(APPEND folder /glibc-hwcaps/${level})
    set(suffix _${level})
  endif()
  get_property(objects GLOBAL PROPERTY HAPBENCH_OBJECTS${suffix})
  add_library(${target} SHARED ${objects})
  # Before version 1, a minor version may change the headers.
  set_target_properties(${target} PROPERTIES
    OUTPUT_NAME hapbench
    LIBRARY_OUTPUT_DIRECTORY ${folder}
    LINKER_LANGUAGE CXX
    VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  # -Bsymbolic-functions: calls within the library go straight to their function.
  target_link_options(${target} PRIVATE -Wl,-Bsymbolic-functions -Wl,--as-needed -Wl,--no-undefined)
  target_link_libraries(${target} PRIVATE ${headers} $<BUILD_INTERFACE:hapbench_flags>)
  if(level)
    add_dependencies(hapbench ${target})
  endif()
endforeach()
