# Writes the header OUTPUT with the commit of SOURCE_DIR. Each build runs this script, which leaves an unchanged header
# alone. The commit is "unknown" if GIT is empty, or if SOURCE_DIR is not the root of a repository.
cmake_minimum_required(VERSION 3.25)

set(commit "unknown")
if(GIT)
  # Name the repository by --git-dir, because git otherwise refuses a tree that belongs to another user. The
  # command only reads.
  execute_process(COMMAND ${GIT} --no-optional-locks --git-dir=${SOURCE_DIR}/.git --work-tree=${SOURCE_DIR} -C ${SOURCE_DIR}
      describe --always --dirty --abbrev=12
    OUTPUT_VARIABLE description RESULT_VARIABLE status ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(status EQUAL 0)
    set(commit "${description}")
  endif()
endif()
file(CONFIGURE OUTPUT "${OUTPUT}" CONTENT "#pragma once\n#define HAPBENCH_COMMIT \"@commit@\"\n" @ONLY)
