# The kernels for NVIDIA devices, as text in the program (src/world/device/kernels/). AUTO makes them where there are
# clang and llvm 14 with the NVPTX target (Debian: clang-14, llvm-14), ON asks for them, OFF leaves them out; a
# build without them says so when it is asked for the backend.
set(SCREE_CUDA AUTO CACHE STRING "Kernels for NVIDIA devices: AUTO, ON or OFF")
if(NOT SCREE_CUDA STREQUAL "OFF" AND CMAKE_SYSTEM_NAME STREQUAL "Linux")
  find_program(SCREE_CLANG_NVPTX NAMES clang-14)
  find_path(SCREE_LLVM_BIN NAMES llvm-link HINTS /usr/lib/llvm-14/bin NO_DEFAULT_PATH)
  if(SCREE_CLANG_NVPTX AND SCREE_LLVM_BIN)
    set(SCREE_WITH_CUDA ON)
  elseif(SCREE_CUDA STREQUAL "ON")
    message(FATAL_ERROR "SCREE_CUDA=ON needs clang-14 and llvm-14 (Debian: apt-get install clang-14 llvm-14)")
  endif()
endif()
if(SCREE_WITH_CUDA)
  set(SCREE_PTX ${CMAKE_BINARY_DIR}/scree_kernels)
  file(GLOB SCREE_PTX_SOURCES CONFIGURE_DEPENDS src/world/*/*.[ch] src/particle/*.[ch] src/base/*.[ch]
       src/world/device/kernels/*.[ch] src/world/device/kernels/include/*.h include/scree/*.h)
  list(FILTER SCREE_PTX_SOURCES EXCLUDE REGEX "/world/(device/[a-z_]*|[a-z]*/(load|code|save|keep|observe|visit|hits|replay|broad|material|describe|bodies))\\.c$")
  add_custom_command(OUTPUT ${SCREE_PTX}.ptx ${SCREE_PTX}.c
    COMMAND ${PROJECT_SOURCE_DIR}/cmake/ptx.sh ${SCREE_CLANG_NVPTX} ${SCREE_LLVM_BIN} ${SCREE_PTX}
    DEPENDS ${PROJECT_SOURCE_DIR}/cmake/ptx.sh ${SCREE_PTX_SOURCES} VERBATIM)
  list(APPEND SCREE_SOURCES ${SCREE_PTX}.c)
endif()
