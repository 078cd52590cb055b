# What `cmake --install` puts where. Components: library, tools, python, package.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS clearway_package EXPORT ClearwayTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY include/clearway DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Clearway)
install(EXPORT ClearwayTargets NAMESPACE Clearway:: DESTINATION ${package_folder}
  COMPONENT library)
# A consumer links the HDF5, OpenMP and PROJ that the library was built with, where they are there.
set(hdf5_library ${HDF5_C_LIBRARY_hdf5})
if(NOT hdf5_library)
  list(GET HDF5_C_LIBRARIES 0 hdf5_library)
endif()
list(GET OpenMP_CXX_LIB_NAMES 0 openmp_name)
set(openmp_library ${OpenMP_${openmp_name}_LIBRARY})
get_target_property(proj_library PROJ::proj LOCATION)
foreach(name hdf5 openmp proj)
  get_filename_component(${name}_folder ${${name}_library} DIRECTORY)
endforeach()
configure_package_config_file(cmake/ClearwayConfig.cmake.in ClearwayConfig.cmake
  INSTALL_DESTINATION ${package_folder} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(ClearwayConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/ClearwayConfig.cmake
  ${PROJECT_BINARY_DIR}/ClearwayConfigVersion.cmake
  DESTINATION ${package_folder} COMPONENT library)
