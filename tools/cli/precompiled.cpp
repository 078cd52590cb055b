// The headers that CMakeLists.txt precompiles need a source to be compiled with.
