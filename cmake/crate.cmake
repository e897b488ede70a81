# SPDX-FileCopyrightText: 2026 The Lightwell Authors
# SPDX-License-Identifier: Apache-2.0
# C sources that Debian does not package and that come with a crate: fetched by name, version and checksum, unpacked under
# build/, never kept in the repository.

set(LIGHTWELL_CRATES "${CMAKE_SOURCE_DIR}/build/crates" CACHE PATH
    "Where crates' sources are unpacked, for all presets; a NAME-VERSION.crate that lies there already is not fetched")

# lightwell_crate(variable name version sha256): variable is the folder of its sources, or false where they cannot be had;
# what is left out then must be said by the caller.
function(lightwell_crate variable name version sha256)
  set(${variable} FALSE PARENT_SCOPE)
  set(archive "${LIGHTWELL_CRATES}/${name}-${version}.crate")
  set(sources "${LIGHTWELL_CRATES}/${name}-${version}")
  file(MAKE_DIRECTORY "${LIGHTWELL_CRATES}")
  file(LOCK "${LIGHTWELL_CRATES}/lock" GUARD FUNCTION TIMEOUT 300)
  if(NOT EXISTS "${archive}")
    # `cargo info` brings one crate into cargo's own cache, checked against its registry, and none of what it depends on.
    find_program(LIGHTWELL_CARGO cargo)
    if(NOT LIGHTWELL_CARGO)
      message(NOTICE "cargo, which fetches ${name}, is not installed")
      return()
    endif()
    execute_process(COMMAND "${LIGHTWELL_CARGO}" info --quiet "${name}@${version}" WORKING_DIRECTORY "${LIGHTWELL_CRATES}"
                    TIMEOUT 120 OUTPUT_QUIET ERROR_VARIABLE error)
    set(home "$ENV{CARGO_HOME}")
    if(NOT home)
      set(home "$ENV{HOME}/.cargo")
    endif()
    file(GLOB cached "${home}/registry/cache/*/${name}-${version}.crate")
    if(NOT cached)
      string(REGEX REPLACE "\n.*" "" error "${error}")
      message(NOTICE "cargo (1.82 or newer is needed) cannot fetch ${name} ${version}: ${error}")
      return()
    endif()
    list(GET cached 0 cached)
    file(COPY_FILE "${cached}" "${archive}")
  endif()
  file(SHA256 "${archive}" found)
  if(NOT found STREQUAL sha256)
    message(FATAL_ERROR "${archive}: its SHA-256 is ${found}, not ${sha256}")
  endif()
  if(NOT EXISTS "${sources}/.unpacked")
    file(ARCHIVE_EXTRACT INPUT "${archive}" DESTINATION "${LIGHTWELL_CRATES}")
    file(TOUCH "${sources}/.unpacked")
  endif()
  set(${variable} "${sources}" PARENT_SCOPE)
endfunction()
