# SPDX-FileCopyrightText: 2026 The Lightwell Authors
# SPDX-License-Identifier: Apache-2.0
# The ARM images: for QEMU's board, and for the STM32F405 a boot program and the same image for each of two slots.
set(shared "${CMAKE_SOURCE_DIR}/interface/sync_protocol.c" "${CMAKE_SOURCE_DIR}/interface/sync_frame.c")
# Or GCC makes memcpy's loop a call of memcpy.
set_source_files_properties(app/memory.c PROPERTIES COMPILE_OPTIONS -fno-tree-loop-distribute-patterns)
set(core_flags -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16)

# lightwell_image(name script sources…): build/firmware/name.elf, laid out by port/script
function(lightwell_image name script)
  add_executable(${name} ${ARGN} app/memory.c port/startup.c)
  # Float literals stay single: the core has no double unit.
  target_compile_options(${name} PRIVATE ${core_flags} -Os -g -ffreestanding -fno-math-errno -fsingle-precision-constant
                         -Wdouble-promotion -ffunction-sections -fdata-sections -fstack-usage)
  target_link_options(${name} PRIVATE ${core_flags} -nostdlib -Wl,--gc-sections -Wl,--print-memory-usage
                      -Wl,-Map=${CMAKE_BINARY_DIR}/${name}.map -L "${CMAKE_CURRENT_SOURCE_DIR}/port"
                      -T "${CMAKE_CURRENT_SOURCE_DIR}/port/${script}")
  target_link_libraries(${name} PRIVATE lightwell_flags gcc)
  set_target_properties(${name} PROPERTIES SUFFIX .elf POSITION_INDEPENDENT_CODE OFF
                        RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}"
                        LINK_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/port/${script};${CMAKE_CURRENT_SOURCE_DIR}/port/image.ld")
endfunction()

file(GLOB mps2 CONFIGURE_DEPENDS "port/mps2/*.c")
lightwell_image(lightwell-sync-mps2 mps2/mps2.ld ${core} ${shared} app/app.c app/main.c ${mps2})

file(GLOB f405 CONFIGURE_DEPENDS "port/f405/*.c")
list(FILTER f405 EXCLUDE REGEX "_absent|verifier")

lightwell_crate(tinyusb tinyusb-sys 0.1.0 1b687e3313858c95112d634b230831fee4e0f80398497407284ebb3d757f3e97)
if(tinyusb)
  set(tinyusb "${tinyusb}/tinyusb/src")
  set(tinyusb_sources tusb.c common/tusb_fifo.c device/usbd.c device/usbd_control.c portable/synopsys/dwc2/dcd_dwc2.c)
  list(TRANSFORM tinyusb_sources PREPEND "${tinyusb}/")
  set_source_files_properties(${tinyusb_sources} PROPERTIES COMPILE_OPTIONS -w)  # not ours to mend
  file(GLOB usb CONFIGURE_DEPENDS "port/f405/usb/*.c")
  list(APPEND f405 ${usb} ${tinyusb_sources})
else()
  message(NOTICE "SKIPPED: USB of the sync board, for want of TinyUSB; its image has the UART alone")
  list(APPEND f405 port/f405/usb_absent.c)
endif()

# Who may sign updates.
set(LIGHTWELL_SYNC_KEY "" CACHE FILEPATH
    "PEM of the Ed25519 key whose signatures the board takes: private, and the images are signed with it, or public. Empty: \
one made for this build folder, for tests")
find_program(LIGHTWELL_OPENSSL openssl)
set(verifier port/f405/verifier_absent.c)
if(monocypher AND LIGHTWELL_OPENSSL)
  set(key "${LIGHTWELL_SYNC_KEY}")
  if(NOT key)
    set(key "${CMAKE_BINARY_DIR}/test-key.pem")
    message(NOTICE "The boards of this build take updates signed with ${key} alone, for tests: LIGHTWELL_SYNC_KEY names a key to keep")
    if(NOT EXISTS "${key}")
      execute_process(COMMAND "${LIGHTWELL_OPENSSL}" genpkey -algorithm ed25519 -out "${key}" COMMAND_ERROR_IS_FATAL ANY)
    endif()
  endif()
  set(sign "${CMAKE_SOURCE_DIR}/scripts/firmware-sign")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${key}")
  execute_process(COMMAND "${sign}" public "${key}" "${CMAKE_BINARY_DIR}/sync_public_key.c" COMMAND_ERROR_IS_FATAL ANY)
  set(verifier port/f405/verifier.c signature/image_signature.c "${CMAKE_BINARY_DIR}/sync_public_key.c"
      ${monocypher_sources})
else()
  message(NOTICE "SKIPPED: updates of the sync board, for want of Monocypher or openssl; its boot program starts image A")
endif()

file(GLOB boot CONFIGURE_DEPENDS "port/f405/boot/*.c")
lightwell_image(lightwell-boot-f405 f405/boot.ld ${boot} core/update.c core/flash.c port/f405/chip_flash.c
                port/f405/watchdog.c ${verifier})
lightwell_image(lightwell-sync-f405-a f405/slot_a.ld ${core} ${shared} app/app.c app/main.c ${f405} ${verifier})
lightwell_image(lightwell-sync-f405-b f405/slot_b.ld ${core} ${shared} app/app.c app/main.c ${f405} ${verifier})
foreach(name lightwell-boot-f405 lightwell-sync-f405-a lightwell-sync-f405-b)
  target_include_directories(${name} SYSTEM PRIVATE freestanding port/f405/usb "${tinyusb}" "${monocypher}"
                             "${monocypher}/optional")
endforeach()

# What goes with every copy of an image.
set(notices "${CMAKE_BINARY_DIR}/THIRD-PARTY.txt")
file(WRITE "${notices}" "The sync board's images contain these programs.\n")
if(tinyusb)
  file(READ "${tinyusb}/../LICENSE" licence)
  file(APPEND "${notices}" "\nTinyUSB\n\n${licence}")
endif()
if(monocypher)
  file(READ "${monocypher}/../LICENCE.md" licence)
  file(APPEND "${notices}" "\nMonocypher\n\n${licence}")
endif()

# The images, signed: for `lightwell board update`, and for a programmer.
if(monocypher AND LIGHTWELL_OPENSSL)
  file(READ "${key}" pem)
  file(STRINGS core/version.h numbers REGEX "#define FIRMWARE_")
  list(TRANSFORM numbers REPLACE ".* " "")
  list(JOIN numbers "." version)
  if(pem MATCHES "PRIVATE")
    set(release "${CMAKE_BINARY_DIR}/lightwell-sync-f405.json")
    add_custom_command(OUTPUT "${release}" "${CMAKE_BINARY_DIR}/lightwell-sync-f405-a.bin"
                       COMMAND "${sign}" sign "${key}" "${version}" $<TARGET_FILE:lightwell-sync-f405-a>
                               $<TARGET_FILE:lightwell-sync-f405-b> --out "${release}"
                               --programmer "${CMAKE_BINARY_DIR}/lightwell-sync-f405-a.bin"
                       DEPENDS lightwell-sync-f405-a lightwell-sync-f405-b "${sign}" "${key}" VERBATIM)
    add_custom_target(lightwell-sync-release ALL DEPENDS "${release}")
  endif()
endif()
