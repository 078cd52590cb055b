# How every target of this tree is compiled. Directory options: nothing of it reaches a consumer.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
# clearway_default_flags(TYPE FLAGS): the flags of a build type, where whoever configures the build
# has left CMake's own.
macro(clearway_default_flags type flags)
  string(STRIP "${CMAKE_CXX_FLAGS_${type}_INIT}" cmakes_own)
  if("${CMAKE_CXX_FLAGS_${type}}" STREQUAL "${cmakes_own}")
    set(CMAKE_CXX_FLAGS_${type} "${flags}")
  endif()
endmacro()
clearway_default_flags(RELEASE "-O3")  # assertions stay on
# For the sanitizers and the fuzzers. gcc takes twice as long with -O2 -g; clang's -g1 leaves out the
# namespaces that tests/tsan.supp goes by.
if(CMAKE_CXX_COMPILER_ID MATCHES Clang)
  clearway_default_flags(RELWITHDEBINFO "-O1 -g")
else()
  clearway_default_flags(RELWITHDEBINFO "-O1 -g1")
endif()

# The predicate's rounding is part of the result: no translation unit may fuse it.
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off>
  $<$<COMPILE_LANGUAGE:CUDA>:-Xcompiler=-ffp-contract=off>)
# Nobody reads the floating-point exceptions, which keep gcc from comparing in vectors.
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fno-trapping-math>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # gcc collects its garbage first at 500 MB, and not at 128 MB: a tenth less time for large units.
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:--param=ggc-min-heapsize=500000>
    -Wno-unused-command-line-argument)  # of clang-tidy, which reads the same options
endif()
set(warnings -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND warnings -Wno-restrict)  # gcc 12 warns of its own std::string (gcc bug 105651)
  if(CLEARWAY_UNITY)
    # gcc takes an anonymous namespace in an included .cpp for one in a header.
    list(APPEND warnings -Wno-subobject-linkage)
  endif()
endif()
if(CLEARWAY_WERROR)
  list(APPEND warnings -Werror)
endif()
add_compile_options("$<$<COMPILE_LANGUAGE:CXX>:${warnings}>")
if(CLEARWAY_SANITIZE)
  add_compile_options(-fsanitize=${CLEARWAY_SANITIZE} -fno-omit-frame-pointer)
  # gcc 12 then takes std::regex for using what is not set (gcc bug 105562).
  add_compile_options($<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  add_link_options(-fsanitize=${CLEARWAY_SANITIZE})
endif()
if(CLEARWAY_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
  # A finding is to end the program, so that the fuzzer keeps the input.
  add_compile_options(-fno-sanitize-recover=all)
endif()

# clearway_sources(VARIABLE): the sources in this folder and below, relative to it.
function(clearway_sources variable)
  file(GLOB_RECURSE sources RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS *.cpp *.cu)
  set(${variable} ${sources} PARENT_SCOPE)
endfunction()

# clearway_unity(TARGET [FOLDER...]): compiles the sources of the target as one (CLEARWAY_UNITY), and
# those in each FOLDER and below as one of their own, the folder that is named first. A source with
# SKIP_UNITY_BUILD_INCLUSION stays alone.
function(clearway_unity target)
  get_target_property(sources ${target} SOURCES)
  foreach(source ${sources})
    set(group of_${target})
    foreach(folder ${ARGN})
      if(source MATCHES "^${folder}/")
        set(group in_${folder})
        break()
      endif()
    endforeach()
    string(MAKE_C_IDENTIFIER "${group}" group)
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${CLEARWAY_UNITY} UNITY_BUILD_MODE GROUP)
endfunction()

# clearway_add_library(NAME [SOURCE...]): a static library of the sources in this folder and below,
# and of further ones.
function(clearway_add_library name)
  clearway_sources(sources)
  add_library(${name} STATIC ${sources} ${ARGN})
  target_compile_features(${name} PUBLIC cxx_std_20)
  target_include_directories(${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
    $<INSTALL_INTERFACE:include>)
  # For the Python module, and for shared libraries of others. Hidden: as fast as before.
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  clearway_unity(${name})
endfunction()
