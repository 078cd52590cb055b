# `cpack` in the build folder makes a Debian package of all that `cmake --install` installs. One
# package: program, library and module of the same version write and read the same files, and a
# single file goes easily to a cluster without network. What only C++ programmers need is suggested.
install(FILES cmake/debian/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/clearway
  COMPONENT package)
find_program(CLEARWAY_GZIP gzip)
if(CLEARWAY_GZIP)
  set(changelog ${PROJECT_BINARY_DIR}/changelog.gz)
  execute_process(COMMAND ${CLEARWAY_GZIP} -9nc ${PROJECT_SOURCE_DIR}/CHANGELOG.md
    OUTPUT_FILE ${changelog} COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${changelog} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/clearway COMPONENT package)
endif()
# Libraries of headers, whose parts are in the binaries: their notices, as Debian has them.
foreach(name libcli11-dev libeigen3-dev libfmt-dev libspdlog-dev libxxhash-dev
    nlohmann-json3-dev pybind11-dev)
  if(EXISTS /usr/share/doc/${name}/copyright)
    install(FILES /usr/share/doc/${name}/copyright RENAME ${name}
      DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/clearway/notices COMPONENT package)
  endif()
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME clearway)
set(CPACK_PACKAGE_VENDOR "The Clearway maintainers")
set(CPACK_PACKAGE_CONTACT "The Clearway maintainers <clearway@localhost>" CACHE STRING
  "Maintainer of the package, with an address")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "collisions of moving models with point clouds")
set(CPACK_PACKAGE_DESCRIPTION
  "Clearway answers one question: does this vehicle pass through this
scanned environment without touching it? It finds, exactly, every
environment point within a search radius of a model that moves along a
trajectory. The package has the program, a C++ library and a Python module.")
set(CPACK_PACKAGE_INSTALL_DIRECTORY clearway)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "cmake, g++, libfmt-dev, libhdf5-dev, libproj-dev, libpugixml-dev, \
libsqlite3-dev, libtbb-dev, python3-h5py, zlib1g-dev")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
if(CLEARWAY_PYTHON_FOUND)
  math(EXPR next "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PACKAGE_DEPENDS "python3 (>= ${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}), \
python3 (<< ${Python3_VERSION_MAJOR}.${next}), python3-numpy")
  set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/debian/postinst
    ${PROJECT_SOURCE_DIR}/cmake/debian/prerm)
endif()
include(CPack)
