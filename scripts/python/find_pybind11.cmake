# Finds Python with its headers, and pybind11: hapbench_python_found. A module serves the one python3 whose headers it was
# compiled with, and that is the system's, which has numpy and matplotlib by scripts/setup; another python3 may come first in
# the path. -DPython_EXECUTABLE names another one.
if(NOT Python_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python_EXECUTABLE /usr/bin/python3)
endif()
find_package(Python 3.9 QUIET COMPONENTS Interpreter Development.Module)
if(Python_Development.Module_FOUND)
  set(PYBIND11_FINDPYTHON ON)
  find_package(pybind11 2.10 CONFIG QUIET)
  if(pybind11_FOUND)
    set(hapbench_python_found ON)
  endif()
endif()
