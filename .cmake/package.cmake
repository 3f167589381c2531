# The Debian package: cpack -G DEB, or scripts/package for all of it.
file(STRINGS ${PROJECT_SOURCE_DIR}/CITATION.cff authors REGEX "^  - name: ")
list(GET authors 0 maintainer)
string(REGEX REPLACE "^  - name: *" "" maintainer "${maintainer}")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME hapbench)
set(CPACK_PACKAGE_VENDOR "${maintainer}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/compress.cmake)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${maintainer}")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "bench for haptic rendering without the hardware")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"A rigid tool, such as a dental drill, is moved through a virtual object; a
force algorithm answers, step by step, with the three forces that a device
without torques can render. hapbench runs such scenes through many algorithms
and measures force, depth, vibration, energy, stability limits and time.
.
The package has the program, the C++ library with its headers, scenarios,
examples and manuals.")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/lib)
set(CPACK_DEBIAN_PACKAGE_DEPENDS python3)
if(TARGET _hapbench)
  # A module serves the one Python it was compiled for.
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  string(APPEND CPACK_DEBIAN_PACKAGE_DEPENDS
    " (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), python3 (<< ${Python_VERSION_MAJOR}.${next_minor})")
endif()
# To draw; to compile against the library.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS
  "python3-matplotlib, python3-numpy, python3-scipy, cmake, g++, libeigen3-dev, nlohmann-json3-dev")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libopenmesh-dev")

# Debian's policy: a copyright file, a changelog in its own form.
set(debian ${PROJECT_BINARY_DIR}/debian)
file(READ ${PROJECT_SOURCE_DIR}/LICENSE license)
file(CONFIGURE OUTPUT ${debian}/copyright CONTENT "hapbench, by @maintainer@\n\n@license@" @ONLY)
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(CONFIGURE OUTPUT ${debian}/changelog @ONLY CONTENT
  "hapbench (@PROJECT_VERSION@) unstable; urgency=medium\n\n  * CHANGELOG.md says what is new.\n\n -- @maintainer@ <none>  @date@\n")
# cpack's own would name the library once for each level.
set(soversion ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
file(CONFIGURE OUTPUT ${debian}/shlibs CONTENT "libhapbench @soversion@ hapbench (>= @soversion@)\n" @ONLY)
file(CONFIGURE OUTPUT ${debian}/triggers CONTENT "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${debian}/shlibs ${debian}/triggers)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
install(FILES ${debian}/copyright ${debian}/changelog DESTINATION share/doc/hapbench)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/lintian-overrides DESTINATION share/lintian/overrides RENAME hapbench)
include(CPack)
