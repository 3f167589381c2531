set(tests_include_root ${PROJECT_BINARY_DIR}/include/tests)
file(MAKE_DIRECTORY ${tests_include_root})
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/tests ${tests_include_root}/tests SYMBOLIC)
