# Rules of `cmake --install`: libraries and headers for find_package(hapbench), their shared files, and the program.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/hapbench)

# Omit the library of the program's commands, which other projects do not need.
get_property(libraries GLOBAL PROPERTY HAPBENCH_LIBRARIES)
list(REMOVE_ITEM libraries hapbench_scenarios_program hapbench_scenarios_program_headers)
get_property(folders GLOBAL PROPERTY HAPBENCH_FOLDERS)
list(REMOVE_ITEM folders scenarios/program)
install(TARGETS ${libraries} EXPORT hapbench-targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT hapbench-targets NAMESPACE hapbench:: DESTINATION ${config_folder})

# Packages that the headers and the code of static libraries need.
set(HAPBENCH_DEPENDENCIES "find_dependency(Eigen3 3.4)\nfind_dependency(nlohmann_json 3.11)\nfind_dependency(fmt 9)
find_dependency(OpenMesh)\nfind_dependency(TBB 2021)")
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/hapbench-config.cmake.in ${PROJECT_BINARY_DIR}/hapbench-config.cmake
  INSTALL_DESTINATION ${config_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/hapbench-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/share_folder.cpp ${PROJECT_BINARY_DIR}/hapbench-config.cmake
  ${PROJECT_BINARY_DIR}/hapbench-config-version.cmake DESTINATION ${config_folder})

foreach(folder ${folders})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder}/ DESTINATION include/hapbench/${folder}
    FILES_MATCHING PATTERN "*.hpp" PATTERN "*.h")
endforeach()

# Files that the program and the libraries read. The program finds them in share/, which must stay beside bin/.
# scripts/python/setup.py packs the component "program": the program, these files and the Python package.
set(share share/hapbench)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenarios/library DESTINATION ${share}/scenarios COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/scenarios/GLOSSARY.md DESTINATION ${share}/scenarios COMPONENT program)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scripts/python DESTINATION ${share}/scripts USE_SOURCE_PERMISSIONS COMPONENT program
  PATTERN __pycache__ EXCLUDE PATTERN setup.py EXCLUDE PATTERN pyproject.toml EXCLUDE
  PATTERN hapbench_program.py EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/results/reference DESTINATION ${share}/results COMPONENT program
  PATTERN figures EXCLUDE PATTERN gallery EXCLUDE)

if(HAPBENCH_BUILD_PROGRAM)
  install(TARGETS hapbench_program RUNTIME DESTINATION bin COMPONENT program)
  install(CODE "set(completion \"${PROJECT_SOURCE_DIR}/scripts/completion\" \"$<TARGET_FILE:hapbench_program>\")" COMPONENT program)
  install(CODE [[
    set(folder "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/share/bash-completion/completions")
    file(MAKE_DIRECTORY ${folder})
    execute_process(COMMAND ${completion} OUTPUT_FILE ${folder}/hapbench COMMAND_ERROR_IS_FATAL ANY)
    message(STATUS "Installing: ${folder}/hapbench")
  ]] COMPONENT program)
endif()

# The renderer is a separate package, for find_package(hapbench_renderer) in projects without C++, and for pkg-config.
if(TARGET hapbench_renderer)
  install(TARGETS hapbench_renderer EXPORT hapbench_renderer-targets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  set(renderer_config ${CMAKE_INSTALL_LIBDIR}/cmake/hapbench_renderer)
  install(EXPORT hapbench_renderer-targets NAMESPACE hapbench:: FILE hapbench_renderer-config.cmake DESTINATION ${renderer_config})
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/hapbench_renderer-config-version.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/hapbench_renderer-config-version.cmake DESTINATION ${renderer_config})
  file(RELATIVE_PATH include_from_pc /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix/include)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/hapbench_renderer.pc.in ${PROJECT_BINARY_DIR}/hapbench_renderer.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/hapbench_renderer.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
  install(FILES ${PROJECT_SOURCE_DIR}/device_model/live/hapbench_renderer.h
    ${PROJECT_SOURCE_DIR}/device_model/live/hapbench_renderer.hpp DESTINATION include)
endif()

# The C interface of modules, which define force laws and contact sources.
install(FILES ${PROJECT_SOURCE_DIR}/algorithms/module/hapbench_module.h DESTINATION include)

# Manuals, and the examples that they link, in the same folders as in the source tree, so that the links work.
file(GLOB_RECURSE manuals RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS
  algorithms/module/examples/* algorithms/module/hapbench_module.h algorithms/module/law_module.hpp algorithms/laws/equal_weights.cpp
  device_model/live/examples/* device_model/live/hapbench_renderer.h device_model/live/hapbench_renderer.hpp
  scenarios/library/validation/*.csv
  scripts/sweep.sbatch scenarios/library/tutorials/*.c tests/consumer/*.c* tests/consumer/CMakeLists.txt tests/consumer/*/*
  sim/*.md algorithms/*.md device_model/*.md results/*.md scenarios/*.md scripts/*.md tests/*.md)
foreach(manual README.md CHANGELOG.md CONTRIBUTING.md LICENSE CITATION.cff ${manuals})
  cmake_path(GET manual PARENT_PATH folder)
  install(FILES ${PROJECT_SOURCE_DIR}/${manual} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder})
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/results/reference/figures ${PROJECT_SOURCE_DIR}/results/reference/gallery
  DESTINATION ${CMAKE_INSTALL_DOCDIR}/results/reference)

if(NOT PROJECT_IS_TOP_LEVEL)
  return()
endif()
# The Debian package: run cpack in the folder of a build. The preset "package" compiles for any processor.
file(STRINGS ${PROJECT_SOURCE_DIR}/CITATION.cff maintainer REGEX "^  - name: " LIMIT_COUNT 1)
string(REGEX REPLACE "^  - name: *" "" maintainer "${maintainer}")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME hapbench)
set(CPACK_PACKAGE_VENDOR "${maintainer}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "bench for haptic rendering without the hardware")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${maintainer}")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"A rigid tool, such as a dental drill, is moved through a virtual object; a
force algorithm answers, step by step, with the three forces that a device
without torques can render. The package has the program, the C++ libraries
with their headers, scenarios, examples and manuals.")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS python3)
if(TARGET _hapbench)
  # The compiled module works only with the minor version of Python that it was compiled for.
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  string(APPEND CPACK_DEBIAN_PACKAGE_DEPENDS
    " (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), python3 (<< ${Python_VERSION_MAJOR}.${next_minor})")
endif()
# Recommended packages draw figures; suggested packages compile programs that use the libraries.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-matplotlib, python3-numpy, python3-scipy")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
  "cmake, g++, libeigen3-dev, nlohmann-json3-dev, libfmt-dev, libopenmesh-dev, libtbb-dev")
include(CPack)
