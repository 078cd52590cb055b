// The headers that tests/CMakeLists.txt precompiles need a source to be compiled with.
