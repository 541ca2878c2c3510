#!/bin/sh
# Makes ../assets/three.bundle.min.js and its licence from the versions pinned in package-lock.json. Only needed when
# three.js changes: the bundle is kept in the repository and building the Rust crate needs neither npm nor a network.
set -eu
cd "$(dirname "$0")"
npm ci --no-audit --no-fund
version=$(node -p 'require("./node_modules/three/package.json").version')
node_modules/.bin/esbuild entry.js --bundle --minify --format=iife --global-name=THREE --target=es2020 \
  --legal-comments=none --charset=ascii \
  --banner:js="/* three.js $version, MIT licence, copyright the three.js authors; see three.LICENSE.txt */" \
  --outfile=../assets/three.bundle.min.js
cp node_modules/three/LICENSE ../assets/three.LICENSE.txt
rm -rf node_modules
