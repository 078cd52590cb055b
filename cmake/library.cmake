# The library as the programs and tests of this project link it.
add_library(clearway_library INTERFACE)
target_link_libraries(clearway_library INTERFACE clearway_search clearway_findings clearway_report)

# As they install it: all objects in one file. Only linking reaches a consumer, no headers or flags.
set(parts core io stream cpu search findings report)
if(CLEARWAY_CUDA_FOUND)
  list(APPEND parts gpu)
endif()
list(TRANSFORM parts REPLACE "(.+)" "$<TARGET_OBJECTS:clearway_\\1>" OUTPUT_VARIABLE objects)
add_library(clearway_package STATIC ${objects})
set_target_properties(clearway_package PROPERTIES
  LINKER_LANGUAGE CXX OUTPUT_NAME clearway EXPORT_NAME clearway)
target_compile_features(clearway_package INTERFACE cxx_std_20)
target_link_libraries(clearway_package INTERFACE
  $<INSTALL_INTERFACE:Clearway::hdf5> $<INSTALL_INTERFACE:Clearway::openmp>
  $<INSTALL_INTERFACE:Clearway::proj>
  $<LINK_ONLY:TBB::tbb> $<LINK_ONLY:Threads::Threads> $<LINK_ONLY:pugixml::pugixml>
  $<LINK_ONLY:SQLite::SQLite3> $<LINK_ONLY:ZLIB::ZLIB> $<LINK_ONLY:fmt::fmt>
  $<$<BOOL:${CLEARWAY_CUDA_FOUND}>:$<LINK_ONLY:CUDA::cudart_static>>)
