# The yardstick is built for this very machine, as its authors' readers would; all else is the portable build.
set_source_files_properties(${PROJECT_SOURCE_DIR}/bench/performance/yardstick.cpp PROPERTIES COMPILE_OPTIONS
  "-O3;-march=native" SKIP_PRECOMPILE_HEADERS ON)
