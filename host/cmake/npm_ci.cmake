# facezip_npm_ci(FOLDER WHAT) installs the packages of the lock file beside the caller's CMakeLists.txt into FOLDER and
# leaves FOLDER/installed for others to depend on. Works on copies: nothing is written into the source tree.

# Node trusts its own certificates alone; behind a proxy with one of its own the system's are needed too.
set(FACEZIP_NODE_CERTIFICATES)
if(NOT DEFINED ENV{NODE_EXTRA_CA_CERTS} AND EXISTS /etc/ssl/certs/ca-certificates.crt)
  set(FACEZIP_NODE_CERTIFICATES NODE_EXTRA_CA_CERTS=/etc/ssl/certs/ca-certificates.crt)
endif()

function(facezip_npm_ci folder what)
  add_custom_command(
    OUTPUT ${folder}/installed
    COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}
    COMMAND ${CMAKE_COMMAND} -E copy package.json package-lock.json ${folder}
    COMMAND ${CMAKE_COMMAND} -E env ${FACEZIP_NODE_CERTIFICATES} ${CMAKE_COMMAND} -E chdir ${folder}
            ${FACEZIP_NPM} ci --ignore-scripts --no-audit --no-fund --loglevel=error
    COMMAND ${CMAKE_COMMAND} -E touch ${folder}/installed
    DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/package.json ${CMAKE_CURRENT_SOURCE_DIR}/package-lock.json
    WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}
    COMMENT "Fetching ${what} (npm ci)"
    VERBATIM)
endfunction()
