# SPDX-FileCopyrightText: 2026 The Lightwell Authors
# SPDX-License-Identifier: Apache-2.0
# Toolchain of the firmware preset.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
