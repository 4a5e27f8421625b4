# SPDX-License-Identifier: Apache-2.0
# Bakes scenes as a step of a build.
cmake_policy(PUSH)
cmake_policy(VERSION 3.20...3.25)  # the depfile is that of Ninja and of Makefiles alike

# chandelier_bake(TARGET SOURCES scene.gltf [rig.glb …] OUTPUT scene.chandelier [OPTIONS --batch-triangles 64 …] [ALL])
#
# Adds a target that bakes the sources into one pack. It bakes again when a source changes, or anything that one names
# (buffers, images), or chandelier-bake itself. A source that does not bake stops the build, and the older pack stays.
# SOURCES count from the current source folder, OUTPUT from the current binary folder. OPTIONS go to chandelier-bake:
# a relative folder in `--cache DIR` would count from where the build runs, so give a whole path. ALL: part of the default build.
# The target's property CHANDELIER_PACK is the pack's path.
function(chandelier_bake target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "ALL" "OUTPUT" "SOURCES;OPTIONS")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "chandelier_bake(${target}): what is '${arg_UNPARSED_ARGUMENTS}'?")
  endif()
  if(NOT arg_SOURCES OR NOT arg_OUTPUT)
    message(FATAL_ERROR "chandelier_bake(${target}): needs SOURCES and OUTPUT")
  endif()
  set(sources)
  foreach(source IN LISTS arg_SOURCES)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
    list(APPEND sources ${source})
  endforeach()
  cmake_path(ABSOLUTE_PATH arg_OUTPUT BASE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR} NORMALIZE OUTPUT_VARIABLE output)
  cmake_path(GET output FILENAME name)
  cmake_path(GET output PARENT_PATH folder)
  file(MAKE_DIRECTORY ${folder})
  add_custom_command(
    OUTPUT ${output}
    COMMAND Chandelier::bake ${sources} -o ${output} --depfile ${output}.d --quiet ${arg_OPTIONS}
    DEPENDS ${sources} $<TARGET_FILE:Chandelier::bake> $<TARGET_FILE:Chandelier::images>
    DEPFILE ${output}.d
    COMMENT "Baking ${name}"
    VERBATIM)
  set(all)
  if(arg_ALL)
    set(all ALL)
  endif()
  add_custom_target(${target} ${all} DEPENDS ${output})
  set_target_properties(${target} PROPERTIES CHANDELIER_PACK ${output})
endfunction()

cmake_policy(POP)
