# The Debian package: cpack in the folder of a build, the preset "package" for any processor.
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
  # A module serves the one Python it was compiled for.
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  string(APPEND CPACK_DEBIAN_PACKAGE_DEPENDS
    " (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), python3 (<< ${Python_VERSION_MAJOR}.${next_minor})")
endif()
# To draw; to compile against the libraries.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-matplotlib, python3-numpy, python3-scipy")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
  "cmake, g++, libeigen3-dev, nlohmann-json3-dev, libfmt-dev, libopenmesh-dev, libtbb-dev")
include(CPack)
