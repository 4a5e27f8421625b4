# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` puts where, and the package that find_package(Chandelier) finds there.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Chandelier)

set_target_properties(chandelier-bake PROPERTIES EXPORT_NAME bake)
set_target_properties(chandelier-inspect PROPERTIES EXPORT_NAME inspect)
set_target_properties(chandelier_images PROPERTIES EXPORT_NAME images)
add_executable(Chandelier::bake ALIAS chandelier-bake)
add_executable(Chandelier::inspect ALIAS chandelier-inspect)
add_library(Chandelier::images ALIAS chandelier_images)
include(ChandelierBake)  # for a project that has Chandelier as a folder of its own

install(TARGETS chandelier-bake chandelier-inspect EXPORT ChandelierTargets RUNTIME)
install(TARGETS chandelier_images EXPORT ChandelierTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/chandelier)
install(EXPORT ChandelierTargets NAMESPACE Chandelier:: DESTINATION ${package_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/ChandelierConfig.cmake.in
                              ${CMAKE_BINARY_DIR}/package/ChandelierConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/ChandelierConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/package/ChandelierConfig.cmake ${CMAKE_BINARY_DIR}/package/ChandelierConfigVersion.cmake
              ${CMAKE_CURRENT_LIST_DIR}/ChandelierBake.cmake
        DESTINATION ${package_dir})

file(GLOB json_schemas CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/schemas/*.schema.json)
install(FILES ${json_schemas} DESTINATION ${CMAKE_INSTALL_DATADIR}/chandelier)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/NOTICE DESTINATION ${CMAKE_INSTALL_DOCDIR})
