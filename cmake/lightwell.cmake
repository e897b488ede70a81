# SPDX-FileCopyrightText: 2026 The Lightwell Authors
# SPDX-License-Identifier: Apache-2.0
# What every room shares: language level, warnings as errors, sanitizers, output folders, and three
# functions (library, executable, tests) so that a room's CMakeLists.txt states only what is its own.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_C_STANDARD 11)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")

option(LIGHTWELL_BUILD_TESTS "Build the tests" ON)
option(LIGHTWELL_FUZZ "Build the fuzz targets; needs Clang" OFF)
set(LIGHTWELL_SANITIZE "" CACHE STRING "Comma-separated sanitizers, for example address,undefined")
set(LIGHTWELL_TEST_DATA "${CMAKE_SOURCE_DIR}/../shared/data" CACHE PATH
    "Real maps and photographs for tests; tests that need them skip visibly where the folder is absent")

find_program(LIGHTWELL_CCACHE ccache)
if(LIGHTWELL_CCACHE)
  set(CMAKE_C_COMPILER_LAUNCHER "${LIGHTWELL_CCACHE}")
  set(CMAKE_CXX_COMPILER_LAUNCHER "${LIGHTWELL_CCACHE}")
endif()

add_library(lightwell_flags INTERFACE)
target_compile_options(lightwell_flags INTERFACE -Wall -Wextra -Wconversion -Wshadow -Werror)
target_include_directories(lightwell_flags INTERFACE "${CMAKE_SOURCE_DIR}" "${CMAKE_BINARY_DIR}/generated")
# Libraries that pkg-config names but nothing calls would still cost the daemon memory.
target_link_options(lightwell_flags INTERFACE -Wl,--as-needed)
if(LIGHTWELL_SANITIZE)
  target_compile_options(lightwell_flags INTERFACE -fsanitize=${LIGHTWELL_SANITIZE} -fno-omit-frame-pointer
                         -fno-sanitize-recover=all)
  # Through a sanitizer's checks GCC takes a moved std::variant's other kinds for uninitialised.
  target_compile_options(lightwell_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(lightwell_flags INTERFACE -fsanitize=${LIGHTWELL_SANITIZE})
  # Not part of undefined, though it is: a number that the integer does not hold.
  if(LIGHTWELL_SANITIZE MATCHES "undefined")
    target_compile_options(lightwell_flags INTERFACE -fsanitize=float-cast-overflow -fno-sanitize-recover=all)
    target_link_options(lightwell_flags INTERFACE -fsanitize=float-cast-overflow)
  endif()
endif()

# lightwell_library(name SOURCES a.cpp … DEPENDS targets …): a room's static library.
function(lightwell_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC ${ARG_DEPENDS} lightwell_flags PRIVATE ${ARG_PRIVATE_DEPENDS})
endfunction()

# lightwell_executable(name SOURCES … DEPENDS …): lands in <build>/bin.
function(lightwell_executable name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS} lightwell_flags)
endfunction()

# lightwell_test(name SOURCES … DEPENDS … [LABELS …] [SERIAL] [TIMEOUT s]): a googletest program, one ctest case a TEST.
function(lightwell_test name)
  cmake_parse_arguments(ARG "SERIAL" "TIMEOUT" "SOURCES;DEPENDS;LABELS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS} lightwell_flags GTest::gmock GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE LIGHTWELL_TEST_DATA="${LIGHTWELL_TEST_DATA}"
                             LIGHTWELL_SOURCE_DIR="${CMAKE_SOURCE_DIR}" LIGHTWELL_BIN_DIR="${CMAKE_BINARY_DIR}/bin")
  set(properties LABELS "${ARG_LABELS}")
  if(ARG_SERIAL)
    list(APPEND properties RUN_SERIAL ON)
  endif()
  if(ARG_TIMEOUT)
    list(APPEND properties TIMEOUT ${ARG_TIMEOUT})
  else()
    list(APPEND properties TIMEOUT 120)
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60 PROPERTIES ${properties})
endfunction()
