# One target per folder: tf_folder(NAME [SHARED] [DEPENDS targets…]) makes the library `tf_NAME` of the folder's sources.
# tf_unit_test(NAME DEPENDS targets…) makes the GoogleTest program `NAME_test` of the folder's sources and registers its cases with ctest.

add_library(tf_options INTERFACE)
target_include_directories(tf_options INTERFACE ${CMAKE_SOURCE_DIR})
# Contraction off: results are bit-identical between machines' code and generated code.
target_compile_options(tf_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror -ffp-contract=off)
target_compile_options(tf_options INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor -Woverloaded-virtual>)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  # False positives on every "literal" + std::string in g++ 12 (GCC PR 105651).
  target_compile_options(tf_options INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-restrict>)
  # Sources that are compiled for optimisation as a whole are linked as they are, but in targets with the property TF_OPTIMISES_WHOLE.
  target_link_options(tf_options INTERFACE $<$<NOT:$<BOOL:$<TARGET_PROPERTY:TF_OPTIMISES_WHOLE>>>:-fno-lto>)
endif()
if(TF_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL Clang)
  # Names of sources that are compiled together would count as shadowed, those in anonymous namespaces as well, which gcc passes over.
  target_compile_options(tf_options INTERFACE -Wno-shadow)
endif()
if(TF_SANITIZE)
  # The sources of the tests have the address sanitizer alone, which Eigen's memory depends on: the behaviour of what they test is watched, and
  # much of the time that a sanitized build takes would be theirs.
  set(is_test $<BOOL:$<TARGET_PROPERTY:TF_IS_TEST>>)
  target_compile_options(tf_options INTERFACE $<IF:${is_test},-fsanitize=address,-fsanitize=address$<COMMA>undefined>
    -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(tf_options INTERFACE -fsanitize=address,undefined)
endif()
if(TF_FUZZ)
  target_compile_options(tf_options INTERFACE -fsanitize=fuzzer-no-link)
endif()

# tf_compile_together(TARGET [EXCEPT sources…]): the target's sources are compiled six at a time, which reads their common headers and
# instantiates their common templates once. Names in the anonymous namespaces of a folder must then differ, but those of the exceptions, which
# are compiled alone.
function(tf_compile_together target)
  cmake_parse_arguments(ARG "" "" "EXCEPT" ${ARGN})
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${TF_UNITY} UNITY_BUILD_BATCH_SIZE 6)
  set_source_files_properties(${ARG_EXCEPT} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

set(TF_TEST_OPTIONS $<$<CONFIG:Release>:-O1>)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  # g++ takes a header that is precompiled for one of the project, and has false positives inside std::string.
  list(APPEND TF_TEST_OPTIONS -Wno-array-bounds -Wno-stringop-overflow)
endif()

# tf_quick_test_build(PROGRAM): its sources take over the headers of tests/support, and are optimised and sanitized little: to build them takes
# longer than to run them.
function(tf_quick_test_build program)
  set_target_properties(${program} PROPERTIES TF_IS_TEST TRUE)
  target_compile_options(${program} PRIVATE ${TF_TEST_OPTIONS})
  target_precompile_headers(${program} REUSE_FROM tf_test_headers)
endfunction()

function(tf_folder name)
  cmake_parse_arguments(ARG "SHARED" "" "DEPENDS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS *.cpp *.c *.h *.def)
  if(ARG_SHARED)
    add_library(tf_${name} SHARED ${sources})
  else()
    add_library(tf_${name} STATIC ${sources})
  endif()
  set_target_properties(tf_${name} PROPERTIES LINKER_LANGUAGE CXX)
  target_link_libraries(tf_${name} PUBLIC tf_options ${ARG_DEPENDS})
endfunction()

# tf_register_tests(PROGRAM): its GoogleTest cases are ctest's, each in a process of its own. With sanitizers, where to start a process takes as
# long as most cases do, a process runs every eighth case.
include(GoogleTest)
function(tf_register_tests program)
  if(NOT TF_SANITIZE)
    gtest_discover_tests(${program} DISCOVERY_TIMEOUT 60)
    return()
  endif()
  foreach(shard RANGE 7)
    add_test(NAME ${program}.${shard} COMMAND ${program} --gtest_brief=1)
    set_tests_properties(${program}.${shard} PROPERTIES ENVIRONMENT "GTEST_TOTAL_SHARDS=8;GTEST_SHARD_INDEX=${shard}")
  endforeach()
endfunction()

function(tf_unit_test name)
  cmake_parse_arguments(ARG "" "" "DEPENDS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS *.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(${name}_test ${sources})
  target_link_libraries(${name}_test PRIVATE tf_options ${ARG_DEPENDS} GTest::gtest GTest::gmock GTest::gtest_main)
  target_compile_definitions(${name}_test PRIVATE TF_SOURCE_DIR="${CMAKE_SOURCE_DIR}" TF_BINARY_DIR="${CMAKE_BINARY_DIR}")
  tf_quick_test_build(${name}_test)
  tf_register_tests(${name}_test)
endfunction()
