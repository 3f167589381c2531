# Writes the header OUTPUT with the commit of SOURCE_DIR. Run by the build; leaves the file alone when nothing changed.
# GIT may be empty. "unknown" without git, outside a repository, or inside a repository of something else.
cmake_minimum_required(VERSION 3.25)

set(commit "unknown")
if(GIT)
  # A tree mounted from another user's account is refused by git unless its folder is named; this only reads it.
  execute_process(COMMAND ${GIT} --no-optional-locks --git-dir=${SOURCE_DIR}/.git --work-tree=${SOURCE_DIR} -C ${SOURCE_DIR}
      describe --always --dirty --abbrev=12
    OUTPUT_VARIABLE description RESULT_VARIABLE status ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(status EQUAL 0)
    set(commit "${description}")
  endif()
endif()
file(CONFIGURE OUTPUT "${OUTPUT}" CONTENT "#pragma once\n#define HAPBENCH_COMMIT \"@commit@\"\n" @ONLY)
