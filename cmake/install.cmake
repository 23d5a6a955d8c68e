# What `cmake --install` lays down: the commands, the library, its headers under include/raymeter, and the package
# files with which find_package(raymeter) gives raymeter::raymeter, raymeter::command
# and raymeter::bench.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/raymeter)
set_target_properties(raymeter PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
target_include_directories(raymeter PUBLIC $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/raymeter>)

install(TARGETS raymeter EXPORT raymeter_targets)
install(TARGETS raymeter_pictures DESTINATION ${CMAKE_INSTALL_LIBDIR}/raymeter)

# Headers that need libraries which users of the others need not have.
set(private_headers
  accel/answer_rays-inl.h accel/brick_build.h accel/brick_packet-inl.h accel/brick_part.h accel/brick_rules.h accel/brick_cells-inl.h accel/brick_walk-inl.h accel/cell_lists.h
  accel/decide_lanes-inl.h accel/packet_frustum-inl.h accel/parallel.h accel/ray_packet-inl.h accel/leaf_queries-inl.h accel/sparse_lists.h
  accel/triangle_block-inl.h accel/two_level_cells.h
  baselines/embree_api.h baselines/embree_device.h
  reports/html/page_template.h
  reports/openimageio/picture_module.h
  scenes/geometry/clipped_roots.h scenes/geometry/exact.h
  scenes/readers/json_place.h
)
foreach(folder scenes accel baselines harness reports)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${folder}/*.h)
  list(REMOVE_ITEM headers ${private_headers})
  foreach(header ${headers})
    cmake_path(GET header PARENT_PATH header_folder)
    install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/raymeter/${header_folder})
  endforeach()
endforeach()
# The commands find the library from where they lie, so that an installed tree may be moved.
file(RELATIVE_PATH library_from_command /${CMAKE_INSTALL_BINDIR} /${CMAKE_INSTALL_LIBDIR})
set_target_properties(raymeter_command raymeter_bench PROPERTIES INSTALL_RPATH $ORIGIN/${library_from_command})
set_target_properties(raymeter_command PROPERTIES EXPORT_NAME command)
set_target_properties(raymeter_bench PROPERTIES EXPORT_NAME bench)
install(TARGETS raymeter_command raymeter_bench EXPORT raymeter_targets)

install(EXPORT raymeter_targets FILE raymeter-targets.cmake NAMESPACE raymeter:: DESTINATION ${package_folder})

configure_package_config_file(cmake/raymeter-config.cmake.in raymeter-config.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(raymeter-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/raymeter-config.cmake ${PROJECT_BINARY_DIR}/raymeter-config-version.cmake
        DESTINATION ${package_folder})
