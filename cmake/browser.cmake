# Small where speed is not asked for: the page has it all inside.
file(GLOB cold src/report/*.c src/cli/*.c src/scene/*.c src/scene/*/*.c src/sample/*.c src/heap/*.c)
set_source_files_properties(${cold} PROPERTIES COMPILE_OPTIONS -Os)
target_compile_options(qhull_sources PRIVATE -Os)
target_compile_options(yaml_sources PRIVATE -Os)

# The program as WebAssembly (preset wasm), twice: `scree` is all of it and reads and writes the system's files through
# Node; `scree_web` has files in memory, the verbs on surfaces, and what the page asks beside them (web/wasm).
# Grown by a twentieth at a time: by a fifth, as is usual, a large scan takes up to 40 MB that nothing uses.
set(memory -sALLOW_MEMORY_GROWTH=1 -sMEMORY_GROWTH_GEOMETRIC_STEP=0.05 -sMAXIMUM_MEMORY=4GB -sINITIAL_MEMORY=32MB -sTOTAL_STACK=4MB)
set(module -sMODULARIZE=1 -sEXPORT_NAME=createScree -sINVOKE_RUN=0 -sEXPORTED_RUNTIME_METHODS=FS,callMain,ccall)
target_link_options(scree PRIVATE ${memory} ${module} -sNODERAWFS=1 -sENVIRONMENT=node -sEXIT_RUNTIME=1)

write_verbs(${CMAKE_BINARY_DIR}/web_verbs.c sample check repair measure distance simplify curve choose clump)
set(objects $<FILTER:$<TARGET_OBJECTS:scree>,EXCLUDE,/verbs\\.c>)
add_executable(scree_web web/wasm/session.c web/wasm/pour.c ${CMAKE_BINARY_DIR}/web_verbs.c ${objects})
set_target_properties(scree_web PROPERTIES C_EXTENSIONS ON) # emscripten.h
set_source_files_properties(web/wasm/session.c web/wasm/pour.c PROPERTIES COMPILE_OPTIONS -Wno-missing-prototypes) # JavaScript calls by name
target_include_directories(scree_web PRIVATE ${PROJECT_SOURCE_DIR}/src)
target_link_libraries(scree_web PRIVATE scree_flags scree_linked)
target_link_options(scree_web PRIVATE ${memory} ${module} -sFORCE_FILESYSTEM=1 -sENVIRONMENT=web,worker,node
                    -sEXPORTED_FUNCTIONS=_main,_malloc,_free)

# build/page/scree.html and build/npm/scree-VERSION.tgz: what is bundled comes from npm's registry, by the lockfile in web/.
find_program(NODE NAMES node nodejs REQUIRED)
find_program(NPM npm REQUIRED)
set(web ${PROJECT_SOURCE_DIR}/web)
add_custom_command(OUTPUT ${web}/node_modules/.package-lock.json DEPENDS ${web}/package-lock.json
  COMMAND ${NPM} ci --silent --ignore-scripts --no-audit --no-fund WORKING_DIRECTORY ${web} VERBATIM)
add_custom_target(page COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_SOURCE_DIR}/build/page
  COMMAND ${NODE} app.mjs ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR}/build/page/scree.html
  DEPENDS scree_web ${web}/node_modules/.package-lock.json WORKING_DIRECTORY ${web} VERBATIM)

set(package ${PROJECT_SOURCE_DIR}/build/npm)
configure_file(${web}/npm/package.json ${CMAKE_BINARY_DIR}/npm/package.json @ONLY)
foreach(file bin/scree.js README.md)
  configure_file(${web}/npm/${file} ${CMAKE_BINARY_DIR}/npm/${file} COPYONLY)
endforeach()
configure_file(${PROJECT_SOURCE_DIR}/LICENSE ${CMAKE_BINARY_DIR}/npm/LICENSE COPYONLY)
set(lib ${CMAKE_BINARY_DIR}/npm/lib)
set(bin ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
add_custom_target(npm COMMAND ${CMAKE_COMMAND} -E make_directory ${lib} ${package}
  COMMAND ${CMAKE_COMMAND} -E copy ${bin}/scree.js ${lib}/scree.cjs
  COMMAND ${CMAKE_COMMAND} -E copy ${bin}/scree.wasm ${lib}
  COMMAND ${NPM} pack --silent --pack-destination ${package}
  DEPENDS scree WORKING_DIRECTORY ${CMAKE_BINARY_DIR}/npm VERBATIM)
