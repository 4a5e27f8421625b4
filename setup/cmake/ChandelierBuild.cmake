# SPDX-License-Identifier: Apache-2.0
# What every target shares: warnings, sanitizers, the system's Python for the generators, and shader compilation.

# Debian's own Python has the packages of setup/packages.txt; another one first in PATH does not.
if(NOT Python3_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python3_EXECUTABLE /usr/bin/python3)
endif()
find_package(Python3 REQUIRED COMPONENTS Interpreter)

find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${CCACHE})
endif()

add_library(chandelier_options INTERFACE)
# Vulkan's structs are filled by naming what matters; the rest is zero.
target_compile_options(chandelier_options INTERFACE -Wall -Wextra -Werror=switch -Wshadow -Wconversion -Wno-sign-conversion
                       $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
                       -Wno-missing-field-initializers)
if(CHANDELIER_SANITIZE)
  add_compile_options(-fsanitize=${CHANDELIER_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${CHANDELIER_SANITIZE})
endif()

if(CHANDELIER_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

# chandelier_compile_quickly(file…): what runs once, and is large by its templates; -O1 compiles it in half of the time.
function(chandelier_compile_quickly)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS $<$<CONFIG:Release>:-O1>)
endfunction()

# chandelier_shaders(TARGET file…): compiles each GLSL file to SPIR-V with glslangValidator and embeds it, so that
# #include "shaders/NAME_EXT.h" gives `constexpr chandelier::gpu::Shader NAME_EXT`, which tells what is to be bound to it.
function(chandelier_shaders target)
  find_program(GLSLANG glslangValidator REQUIRED)
  set(out ${CMAKE_CURRENT_BINARY_DIR}/shaders)
  set(embed ${CMAKE_SOURCE_DIR}/setup/cmake/embed_shader.py)
  foreach(source ${ARGN})
    get_filename_component(name ${source} NAME)
    get_filename_component(path ${source} ABSOLUTE)
    string(REPLACE "." "_" symbol ${name})
    set(header ${out}/${symbol}.h)
    set(spirv ${out}/${symbol}.spv)
    add_custom_command(
      OUTPUT ${spirv}
      COMMAND ${CMAKE_COMMAND} -E make_directory ${out}
      COMMAND ${GLSLANG} --quiet -V --target-env vulkan1.3 -I${CMAKE_SOURCE_DIR}/runtime -I${CMAKE_BINARY_DIR}/generated
              --depfile ${spirv}.d -o ${spirv} ${path}
      DEPENDS ${path} chandelier_generated
      DEPFILE ${spirv}.d
      COMMENT "Shader ${name}"
      VERBATIM)
    add_custom_command(
      OUTPUT ${header}
      COMMAND ${Python3_EXECUTABLE} -B ${embed} ${spirv} ${symbol} ${header}
      DEPENDS ${spirv} ${embed}
      COMMENT "Embedding shader ${name}"
      VERBATIM)
    target_sources(${target} PRIVATE ${header})
  endforeach()
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR})
endfunction()
