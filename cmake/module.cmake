# surefoot_module(NAME [DEPS module...] [LINK target...] [OPENCV component...] [NOT_INSTALLED])
# One static library per module, from every *.cpp in the folder of the CMakeLists.txt and below, and
# one test program from its *_test.cpp. New files need no edit here.
function(surefoot_module name)
  cmake_parse_arguments(ARG "NOT_INSTALLED" "" "DEPS;LINK;OPENCV;TEST_DEPS" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS *.cpp)
  set(tests ${sources})
  list(FILTER sources EXCLUDE REGEX "_test\\.cpp$")
  list(FILTER tests INCLUDE REGEX "_test\\.cpp$")

  set(target surefoot_${name})
  if(sources)
    add_library(${target} STATIC ${sources})
    set(scope PUBLIC)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:surefoot_compile_options>)
    if(ARG_OPENCV)
      surefoot_opencv(${target} ${ARG_OPENCV})
    endif()
    if(ARG_LINK)
      target_link_libraries(${target} PRIVATE ${ARG_LINK})
    endif()
    if(fmt::fmt IN_LIST ARG_LINK)
      surefoot_precompile(${target})
    endif()
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(surefoot::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} ${scope}
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include>)
  target_link_libraries(${target} ${scope} Eigen3::Eigen)
  foreach(dep IN LISTS ARG_DEPS)
    target_link_libraries(${target} ${scope} surefoot::${dep})
  endforeach()
  if(NOT ARG_NOT_INSTALLED)
    set_property(GLOBAL APPEND PROPERTY SUREFOOT_MODULES ${target})
  endif()

  if(SUREFOOT_DEVELOPER AND tests)
    surefoot_test(${name} SOURCES ${tests} DEPS ${name} ${ARG_TEST_DEPS} OPENCV ${ARG_OPENCV} LINK ${ARG_LINK})
  endif()
endfunction()

# surefoot_test(NAME SOURCES file... DEPS module...): a GoogleTest program, one ctest entry per test.
function(surefoot_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS;OPENCV;LINK" ${ARGN})
  set(target ${name}_test)
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE surefoot_compile_options GTest::gtest GTest::gtest_main ${ARG_LINK})
  foreach(dep IN LISTS ARG_DEPS)
    target_link_libraries(${target} PRIVATE surefoot::${dep})
  endforeach()
  if(ARG_OPENCV)
    surefoot_opencv(${target} ${ARG_OPENCV})
  endif()
  target_compile_definitions(${target} PRIVATE
    SUREFOOT_SOURCE_DIR="."
    SUREFOOT_DEFAULT_DATA_DIR="../shared/data")
  set(test_timeout_s 300)
  if(SUREFOOT_SANITIZE)
    set(test_timeout_s 1800)  # sanitizers slow code down five to twenty times
  endif()
  # Tests run in the source folder. Paths in the code are relative, so that all clones share the ccache.
  gtest_discover_tests(${target} NO_PRETTY_VALUES TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    PROPERTIES TIMEOUT ${test_timeout_s} ENVIRONMENT "ASAN_OPTIONS=detect_leaks=1")
endfunction()
