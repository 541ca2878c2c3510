// The 3D view of an osculate report. Reads the JSON head and the base64 block that stand in the page, draws with the
// bundled three.js (global THREE), and falls back to the still picture where WebGL is missing.
// Frame: the part's, mm, z up. Deviation: positive is material left, negative is gouge.
(function () {
  "use strict";

  const $ = (id) => document.getElementById(id);
  const head = JSON.parse($("report-head").textContent);
  const box = $("canvas-box");

  // ---- data -------------------------------------------------------------------------------------------------------

  function decodeBase64(text) {
    const binary = atob(text.trim());
    const bytes = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; i++) bytes[i] = binary.charCodeAt(i);
    return bytes.buffer;
  }

  // The data as the report packed them; filled before anything is drawn.
  let block = null;

  async function unpack() {
    const packed = new Blob([decodeBase64($("report-data").textContent)]);
    $("report-data").textContent = "";
    block = await new Response(packed.stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
  }

  // The bytes of so many records, of which all first bytes stand first, then all second ones and so on.
  function records(at, count, size) {
    const from = new Uint8Array(block, at, count * size);
    const out = new Uint8Array(count * size);
    for (let k = 0, i = 0; k < size; k++) for (let r = 0; r < count; r++) out[r * size + k] = from[i++];
    return out.buffer;
  }
  const floats = (at, count, stride) => new Float32Array(records(at, count, 4 * stride));

  // Values that stand there as differences from the one `stride` before.
  function summed(list, stride) {
    for (let i = stride; i < list.length; i++) list[i] += list[i - stride];
    return list;
  }

  function points(at, count) {
    const steps = summed(new Uint16Array(records(at, count, 6)), 3);
    const out = new Float32Array(3 * count);
    for (let i = 0; i < out.length; i++) out[i] = head.lo[i % 3] + head.step[i % 3] * steps[i];
    return out;
  }

  // Unfolds the octahedron.
  function normals(at, count) {
    const steps = summed(new Int16Array(records(at, count, 4)), 2);
    const out = new Float32Array(3 * count);
    for (let i = 0; i < count; i++) {
      let x = steps[2 * i] / 4095;
      let y = steps[2 * i + 1] / 4095;
      const z = 1 - Math.abs(x) - Math.abs(y);
      const fold = Math.max(-z, 0);
      x += x < 0 ? fold : -fold;
      y += y < 0 ? fold : -fold;
      const length = Math.hypot(x, y, z);
      out.set([x / length, y / length, z / length], 3 * i);
    }
    return out;
  }

  // ---- colours ----------------------------------------------------------------------------------------------------

  const UNKNOWN = head.unknown;

  // Stops as [value, r, g, b]; at a step the value belongs to the side nearer to zero.
  function colourOf(stops, value) {
    if (!Number.isFinite(value)) return UNKNOWN;
    const first = stops[0];
    const last = stops[stops.length - 1];
    if (value < first[0]) return first.slice(1);
    if (value > last[0]) return last.slice(1);
    let pair = null;
    for (let i = 0; i + 1 < stops.length; i++) {
      const [a, b] = [stops[i], stops[i + 1]];
      if (a[0] >= b[0]) continue;
      if (value > 0 ? value <= b[0] : a[0] <= value) {
        pair = [a, b];
        if (value > 0) break;
      }
    }
    if (!pair) return last.slice(1);
    const t = (value - pair[0][0]) / (pair[1][0] - pair[0][0]);
    return [1, 2, 3].map((k) => Math.round(pair[0][k] + (pair[1][k] - pair[0][k]) * t));
  }

  const TEXELS = 4096;

  function rangeOf(scale) {
    const lo = scale.stops[0][0];
    const hi = scale.stops[scale.stops.length - 1][0];
    return hi > lo ? [lo, hi] : [lo - 0.5, lo + 0.5];
  }

  function textureOf(scale) {
    const [lo, hi] = rangeOf(scale);
    const data = new Uint8Array(4 * TEXELS);
    for (let i = 0; i < TEXELS; i++) {
      data.set([...colourOf(scale.stops, lo + ((hi - lo) * (i + 0.5)) / TEXELS), 255], 4 * i);
    }
    const texture = new THREE.DataTexture(data, TEXELS, 1);
    texture.colorSpace = THREE.SRGBColorSpace;
    texture.magFilter = texture.minFilter = THREE.NearestFilter;
    texture.needsUpdate = true;
    return texture;
  }

  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  // ---- numbers ----------------------------------------------------------------------------------------------------

  const MINUS = "\u2212";
  const fixed = (value, digits) =>
    Number.isFinite(value) ? value.toFixed(digits).replace(/^-(?=[0.]*$)/, "").replace("-", MINUS) : "\u2013";
  const signed = (value, digits) => (value > 0 ? "+" : "") + fixed(value, digits);

  // ---- scene ------------------------------------------------------------------------------------------------------

  function start() {
    const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: false });
    renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    // Under the legends and buttons, which stand after it in the box.
    box.prepend(renderer.domElement);
    renderer.domElement.setAttribute("aria-label", "3D view of the part; drag to turn, wheel to zoom, right button to shift");

    const scene = new THREE.Scene();
    const camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 10);
    camera.up.set(0, 0, 1);
    const controls = new THREE.OrbitControls(camera, renderer.domElement);
    controls.zoomToCursor = true;
    controls.rotateSpeed = 0.9;

    const lo = new THREE.Vector3(...head.lo);
    const hi = lo.clone().add(new THREE.Vector3(...head.step).multiplyScalar(65535));
    const radius = Math.max(0.5 * hi.distanceTo(lo), 1e-3);

    // All that is in the part's frame. With the machine shown its bed stands still and this moves; else it stands still itself.
    const world = new THREE.Group();
    world.matrixAutoUpdate = false;
    scene.add(world);
    const inWorld = (point) => point.clone().applyMatrix4(world.matrix);

    const ambient = new THREE.AmbientLight(0xffffff, 1);
    const lamp = new THREE.DirectionalLight(0xffffff, 1);
    scene.add(ambient, lamp, lamp.target);

    // ---- part -----------------------------------------------------------------------------------------------------

    // One material for all faces: the colour comes from a value at each vertex, looked up at each pixel, so that the
    // step at a tolerance is a sharp line and not smeared over a triangle.
    const uniforms = {
      lookup: { value: null },
      range: { value: new THREE.Vector2(0, 1) },
      unknown: { value: new THREE.Color().setRGB(...UNKNOWN.map((c) => c / 255), THREE.SRGBColorSpace) },
      mapped: { value: 1 },
    };
    const partMaterial = new THREE.MeshLambertMaterial({
      side: THREE.DoubleSide,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    });
    partMaterial.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, uniforms);
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", "#include <common>\nattribute vec2 quantity;\nvarying vec2 vQuantity;")
        .replace("#include <begin_vertex>", "#include <begin_vertex>\nvQuantity = quantity;");
      shader.fragmentShader = shader.fragmentShader
        .replace(
          "#include <common>",
          "#include <common>\nvarying vec2 vQuantity;\nuniform sampler2D lookup;\nuniform vec2 range;\n" +
            "uniform vec3 unknown;\nuniform float mapped;"
        )
        .replace(
          "#include <color_fragment>",
          `#include <color_fragment>
          if (mapped > 0.5) {
            float share = (vQuantity.x - range.x) / (range.y - range.x);
            diffuseColor.rgb = vQuantity.y > 0.999 ? texture2D(lookup, vec2(share, 0.5)).rgb : unknown;
          }`
        );
    };

    const part = new THREE.Group();
    const borders = new THREE.Group();
    const borderMaterial = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.75 });
    for (const face of head.faces) {
      const position = new THREE.BufferAttribute(points(face.position, face.vertices), 3);
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", position);
      geometry.setAttribute("normal", new THREE.BufferAttribute(normals(face.normal, face.vertices), 3));
      geometry.setAttribute("quantity", new THREE.BufferAttribute(new Float32Array(2 * face.vertices), 2));
      const corners = 3 * face.triangles;
      const steps = face.wide ? new Uint32Array(block, face.index, corners) : new Uint16Array(records(face.index, corners, 2));
      geometry.setIndex(new THREE.BufferAttribute(summed(steps, 1), 1));
      const mesh = new THREE.Mesh(geometry, partMaterial);
      mesh.userData = {
        id: face.id,
        checked: face.checked,
        deviation: floats(face.deviation, face.vertices, 1),
        scalars: face.scalars.map((at) => floats(at, face.vertices, 1)),
      };
      part.add(mesh);
      if (face.borders > 0) {
        const edges = new THREE.BufferGeometry();
        edges.setAttribute("position", position);
        edges.setIndex(new THREE.BufferAttribute(summed(new Uint32Array(block, face.border, 2 * face.borders), 1), 1));
        borders.add(new THREE.LineSegments(edges, borderMaterial));
      }
    }
    world.add(part);

    const textures = new Map();
    let shownScale = null;
    function colourPart(mode) {
      shownScale = mode === "deviation" ? head.deviation : mode === "plain" ? null : head.scalars[Number(mode)];
      uniforms.mapped.value = shownScale ? 1 : 0;
      // Seen face-on the light adds up to one: the colour is then exactly the legend's.
      ambient.intensity = Math.PI * (shownScale ? 0.6 : 0.32);
      lamp.intensity = Math.PI * (shownScale ? 0.42 : 0.74);
      for (const legend of document.querySelectorAll("[data-part-legend]")) {
        legend.hidden = legend.dataset.partLegend !== mode;
      }
      if (shownScale) {
        if (!textures.has(mode)) textures.set(mode, textureOf(shownScale));
        uniforms.lookup.value = textures.get(mode);
        uniforms.range.value.set(...rangeOf(shownScale));
        let knownOnes = 0;
        let all = 0;
        for (const mesh of part.children) {
          const values = mode === "deviation" ? mesh.userData.deviation : mesh.userData.scalars[Number(mode)];
          const attribute = mesh.geometry.getAttribute("quantity");
          for (let i = 0; i < values.length; i++) {
            const known = !Number.isNaN(values[i]);
            knownOnes += known;
            // What exceeds the scale is clamped, or an infinite value would spoil its whole triangle.
            const inside = Math.min(Math.max(values[i], -1e6), 1e6);
            attribute.setXY(i, known ? inside : 0, known ? 1 : 0);
          }
          all += values.length;
          attribute.needsUpdate = true;
        }
        box.dataset.known = String(knownOnes / Math.max(all, 1));
      }
      needle(null);
      redraw();
    }

    // ---- path -----------------------------------------------------------------------------------------------------

    // Lines on the surface are shifted towards the viewer by this much, or the part would swallow them in places; in an
    // orthographic view that moves nothing sideways.
    const lift = 0.006 * radius;
    const overlay = new THREE.Group();
    world.add(overlay);
    overlay.add(borders);

    const path = head.path;
    const segmentsUpTo = [0];
    let lines = null;
    let lineMaterial = null;
    let widthColours = null;
    if (path.points > 1) {
      const at = points(path.position, path.points);
      const widths = floats(path.width, path.points, 1);
      const segments = path.counts.reduce((sum, n) => sum + Math.max(n - 1, 0), 0);
      const ends = new Float32Array(6 * segments);
      widthColours = new Float32Array(6 * segments);
      const colour = new THREE.Color();
      let from = 0;
      let k = 0;
      for (const count of path.counts) {
        for (let i = from; i + 1 < from + count; i++, k++) {
          ends.set(at.subarray(3 * i, 3 * i + 6), 6 * k);
          if (!head.width) continue;
          [i, i + 1].forEach((j, end) => {
            const rgb = colourOf(head.width.stops, widths[j]);
            colour.setRGB(rgb[0] / 255, rgb[1] / 255, rgb[2] / 255, THREE.SRGBColorSpace);
            widthColours.set([colour.r, colour.g, colour.b], 6 * k + 3 * end);
          });
        }
        from += count;
        segmentsUpTo.push(k);
      }
      if (segments > 0) {
        const geometry = new THREE.LineSegmentsGeometry();
        geometry.setPositions(ends);
        geometry.setColors(widthColours);
        lineMaterial = new THREE.LineMaterial({ linewidth: 1.4, transparent: true });
        lines = new THREE.LineSegments2(geometry, lineMaterial);
        lines.frustumCulled = false;
        overlay.add(lines);
      }
    }

    function colourPath(mode) {
      if (!lines) return;
      lines.visible = mode !== "off";
      const byWidth = mode === "width";
      lineMaterial.vertexColors = byWidth;
      lineMaterial.linewidth = byWidth ? 2.6 : 1.1;
      lineMaterial.opacity = byWidth ? 1 : 0.5;
      lineMaterial.color.set(byWidth ? "#ffffff" : css("--path"));
      lineMaterial.needsUpdate = true;
      for (const legend of document.querySelectorAll("[data-path-legend]")) legend.hidden = !byWidth;
      redraw();
    }

    const links = new THREE.Group();
    const linkMaterials = [false, true].map((rapid) => {
      const material = new THREE.LineMaterial({ linewidth: 1.4, dashed: rapid });
      material.dashSize = 0.012 * radius;
      material.gapSize = 0.008 * radius;
      material.color.set(rapid ? "#d9480f" : "#0b7fc4");
      return material;
    });
    for (const rapid of [false, true]) {
      const ends = [];
      for (const link of head.links.filter((l) => l.rapid === rapid)) {
        const p = floats(link.at, link.count, 3);
        for (let i = 0; i + 1 < link.count; i++) ends.push(...p.subarray(3 * i, 3 * i + 6));
      }
      if (ends.length === 0) continue;
      const geometry = new THREE.LineSegmentsGeometry();
      geometry.setPositions(new Float32Array(ends));
      const object = new THREE.LineSegments2(geometry, linkMaterials[Number(rapid)]);
      object.computeLineDistances();
      object.frustumCulled = false;
      links.add(object);
    }
    links.visible = false;
    world.add(links);

    // ---- tool -----------------------------------------------------------------------------------------------------

    const tool = new THREE.Group();
    const inHand = head.tools.map(() => new THREE.Group());
    for (const one of inHand) tool.add(one);
    const toolMaterials = [];
    // A tool that stands over the place that is looked at lets it through.
    function seeThrough(on) {
      for (const { material, opacity } of toolMaterials) {
        material.opacity = on ? Math.min(opacity, 0.3) : opacity;
        material.transparent = material.opacity < 1;
        material.depthWrite = !on;
        material.needsUpdate = true;
      }
    }
    const pieceColours = { cutter: "#d6ab45", shank: "#b3bbc5", holder: "#69747f" };
    head.tools.forEach(({ pieces }, which) => pieces.forEach((piece, number) => {
      const material = new THREE.MeshLambertMaterial({ color: pieceColours[piece.kind], side: THREE.DoubleSide });
      const opacity = { cutter: 1, shank: 0.85, holder: 0.55 }[piece.kind];
      toolMaterials.push({ material, opacity });
      // Where the next piece stands on this one, the lid would flicker through its floor.
      const outline = number + 1 < pieces.length ? piece.outline.slice(0, -1) : piece.outline;
      // The lathe smooths its normals along the outline: it gets one run at a time, cut at the sharp edges.
      let run = [outline[0]];
      for (let i = 1; i < outline.length; i++) {
        run.push(outline[i]);
        const [a, b, c] = [outline[i - 1], outline[i], outline[i + 1]];
        const turn = c && Math.abs(Math.atan2(
          (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]),
          (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1])
        ));
        if (!c || turn > 0.5) {
          inHand[which].add(new THREE.Mesh(new THREE.LatheGeometry(run.map(([r, z]) => new THREE.Vector2(r, z)), 64), material));
          run = [b];
        }
      }
    }));
    world.add(tool);
    seeThrough(false);

    const perPose = head.poses.numbers;
    const poses = floats(head.poses.at, head.poses.count, perPose);
    const slider = $("pose");

    // ---- machine --------------------------------------------------------------------------------------------------

    // Frame k is what the first k joints make of the table's, as in the machine file, slides at the spindle nose; the bed is behind the
    // joints of the table.
    const machine = head.machine;
    const placesOfPart = (machine?.setups ?? []).map((columns) => new THREE.Matrix4().fromArray(columns));
    const bed = machine ? machine.joints.filter((joint) => joint.table).length : 0;
    const bodies = new THREE.Group();
    bodies.visible = false;
    world.add(bodies);
    const bodyMaterials = [["#8d99a6", 0.85], ["#7f97b5", 0.4]].map(([color, opacity]) =>
      new THREE.MeshLambertMaterial({ color, opacity, transparent: true, side: THREE.DoubleSide, depthWrite: opacity > 0.5 })
    );

    function shapeOf(piece) {
      if (piece.corners) {
        const [a, b] = piece.corners.map((corner) => new THREE.Vector3(...corner));
        const size = b.clone().sub(a);
        return new THREE.BoxGeometry(size.x, size.y, size.z).translate(...a.add(b).multiplyScalar(0.5).toArray());
      }
      if (piece.ends) {
        const [a, b] = piece.ends.map((end) => new THREE.Vector3(...end));
        const [low, high] = piece.radii;
        const long = a.distanceTo(b);
        const outline = [[0, 0], [low, 0], [low, 0], [high, long], [high, long], [0, long]];
        const geometry = new THREE.LatheGeometry(outline.map(([r, z]) => new THREE.Vector2(r, z)), 64);
        const turn = new THREE.Mesh();
        turn.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), b.sub(a).normalize());
        turn.position.copy(a);
        turn.updateMatrix();
        return geometry.applyMatrix4(turn.matrix);
      }
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(floats(piece.at, piece.count, 9), 3));
      geometry.computeVertexNormals();
      return geometry;
    }

    for (const body of machine?.bodies ?? []) {
      const whole = new THREE.Group();
      whole.matrixAutoUpdate = false;
      whole.userData = { frame: body.frame };
      for (const piece of body.pieces) whole.add(new THREE.Mesh(shapeOf(piece), bodyMaterials[Number(body.head)]));
      bodies.add(whole);
    }

    // Where the joints stand at a pose; null where that is not known.
    function jointsAt(index) {
      if (!machine) return null;
      const from = perPose * index + perPose - machine.joints.length;
      const joints = poses.subarray(from, from + machine.joints.length);
      return joints.every(Number.isFinite) ? joints : null;
    }

    function turnsOf(joints) {
      const turns = machine.joints.map((joint, k) =>
        joint.turns ? `${joint.letter} ${fixed((joints[k] * 180) / Math.PI, 2)}\u00b0` : "");
      return turns.filter(Boolean).join(" ");
    }

    function frames(joints) {
      const out = [new THREE.Matrix4()];
      machine.joints.forEach((joint, k) => {
        const along = new THREE.Vector3(...joint.direction);
        const step = new THREE.Matrix4();
        if (joint.turns) {
          step.makeRotationAxis(along, joints[k]);
          const point = new THREE.Vector3(...joint.point);
          step.setPosition(point.clone().sub(point.clone().applyMatrix4(step)));
        } else {
          step.setPosition(along.multiplyScalar(joints[k]));
        }
        out.push(out[k].clone().multiply(step));
      });
      return out;
    }

    // Puts the bodies where the joints have them; what a length of the tool above the tip is off the spindle's nose stands in the page
    // for those who check it.
    function stand(index, joints) {
      if (!joints || bodies.children.length === 0) return;
      const all = frames(joints);
      const place = placesOfPart[poses[perPose * index + 10]];
      const back = place.clone().invert();
      for (const body of bodies.children) body.matrix.multiplyMatrices(back, all[body.userData.frame]);
      if (bodies.visible) world.matrix.copy(all[bed]).invert().multiply(place);
      else world.matrix.identity();
      world.updateMatrixWorld(true);
      const nose = new THREE.Vector3().applyMatrix4(all[all.length - 1]).applyMatrix4(back);
      const top = new THREE.Vector3(0, toolLengths[poses[perPose * index + 8]], 0).applyQuaternion(tool.quaternion).add(tool.position);
      box.dataset.nose = String(nose.distanceTo(top));
    }
    const toolLengths = head.tools.map(({ pieces }) => Math.max(...pieces.flatMap((p) => p.outline.map(([, z]) => z)), 0));

    function showMachine(on) {
      bodies.visible = on;
      showPose(Number(slider.value));
      resize();
      fit(directions.iso);
    }

    // ---- place of the tool ----------------------------------------------------------------------------------------

    const upright = new THREE.Vector3(0, 1, 0);
    let passNow = -1;

    function showPose(index) {
      if (head.poses.count === 0) return;
      const [x, y, z, i, j, k, time, pass, which, line] = poses.subarray(perPose * index, perPose * (index + 1));
      const joints = jointsAt(index);
      inHand.forEach((one, number) => { one.visible = number === which; });
      tool.position.set(x, y, z);
      const axis = new THREE.Vector3(i, j, k).normalize();
      tool.quaternion.setFromUnitVectors(upright, axis);
      passNow = pass;
      const tilt = (Math.acos(Math.min(Math.max(axis.z, -1), 1)) * 180) / Math.PI;
      const words = [
        `tip ${fixed(x, 2)}, ${fixed(y, 2)}, ${fixed(z, 2)} mm`,
        joints ? turnsOf(joints) : `axis ${fixed(tilt, 1)}\u00b0 from z`,
      ];
      if (pass >= 0) words.unshift(`pass ${pass + 1} of ${path.counts.length}`);
      if (head.tools.length > 1) words.unshift(head.tools[which].label);
      if (line > 0) words.unshift(`line ${line}`);
      if (Number.isFinite(time)) words.unshift(`${fixed(time, 2)} min`);
      $("pose-words").textContent = words.filter(Boolean).join("  \u00b7  ");
      stand(index, joints);
      limitPath();
      redraw();
    }

    // The last pass begun up to a pose: between passes that is the one before.
    const begun = new Int32Array(head.poses.count);
    for (let i = 0, last = -1; i < begun.length; i++) {
      last = Math.max(last, poses[perPose * i + 7]);
      begun[i] = last;
    }

    function limitPath() {
      if (!lines) return;
      const all = segmentsUpTo[segmentsUpTo.length - 1];
      const upTo = $("so-far").checked && begun.length > 0 ? begun[Number(slider.value)] + 1 : segmentsUpTo.length - 1;
      lines.geometry.instanceCount = Math.min(segmentsUpTo[Math.min(upTo, segmentsUpTo.length - 1)], all);
    }

    let playing = false;
    let playedAt = 0;
    let exact = 0;
    const PLAY_S = 40;
    function play(on) {
      playing = on;
      if (on) seeThrough(false);
      $("play").textContent = on ? "Pause" : "Play";
      if (!on) return;
      exact = Number(slider.value) >= begun.length - 1 ? 0 : Number(slider.value);
      playedAt = performance.now();
      requestAnimationFrame(advance);
    }
    function advance(now) {
      if (!playing) return;
      exact += (Math.max(now - playedAt, 0) / 1000) * (begun.length / PLAY_S);
      playedAt = now;
      slider.value = Math.floor(exact);
      showPose(Number(slider.value));
      if (exact >= begun.length - 1) play(false);
      else requestAnimationFrame(advance);
    }

    // ---- pointing -------------------------------------------------------------------------------------------------

    const tip = $("hover");
    const raycaster = new THREE.Raycaster();
    const marker = new THREE.Mesh(
      new THREE.SphereGeometry(1, 16, 12),
      new THREE.MeshBasicMaterial({ color: "#ffffff", depthTest: false, transparent: true })
    );
    marker.renderOrder = 10;
    const markerRim = new THREE.Mesh(
      marker.geometry,
      new THREE.MeshBasicMaterial({ color: "#111820", depthTest: false, transparent: true })
    );
    markerRim.renderOrder = 9;
    marker.visible = markerRim.visible = false;
    world.add(markerRim, marker);

    function verdictWords(deviation, checked) {
      const { scallop, gouge } = head.limits;
      if (!Number.isFinite(deviation)) return ["not verified here", ""];
      if (checked && deviation >= 0) return ["not cut; not to be machined", "good"];
      if (deviation < 0) {
        if (!(gouge > 0)) return ["gouge, no limit given", ""];
        return deviation < -gouge ? ["gouge, out of tolerance", "bad"] : ["undercut, within tolerance", "good"];
      }
      if (!(scallop > 0)) return ["material left, no limit given", ""];
      return deviation > scallop ? ["too much material left", "bad"] : ["within tolerance", "good"];
    }

    function needle(value) {
      for (const legend of document.querySelectorAll("[data-part-legend]")) {
        const mark = legend.querySelector(".needle");
        if (!mark || !shownScale || legend.hidden || !Number.isFinite(value)) {
          if (mark) mark.style.display = "none";
          continue;
        }
        const [a, b] = rangeOf(shownScale);
        const share = Math.min(Math.max((value - a) / (b - a), 0), 1);
        mark.style.display = "";
        mark.setAttribute("transform", `translate(0 ${head.legend_length * (1 - share)})`);
      }
    }

    let pointer = null;
    function pick() {
      if (!pointer || playing) return hideTip();
      const area = renderer.domElement.getBoundingClientRect();
      const x = ((pointer.clientX - area.left) / area.width) * 2 - 1;
      const y = 1 - ((pointer.clientY - area.top) / area.height) * 2;
      raycaster.setFromCamera(new THREE.Vector2(x, y), camera);
      const hit = raycaster.intersectObjects(part.children, false)[0];
      if (!hit) return hideTip();
      const { deviation, scalars, id, checked } = hit.object.userData;
      const corners = [hit.face.a, hit.face.b, hit.face.c];
      const weights = [hit.barycoord.x, hit.barycoord.y, hit.barycoord.z];
      const value = (list) => corners.reduce((sum, c, i) => sum + list[c] * weights[i], 0);
      const d = value(deviation);
      const [words, kind] = verdictWords(d, checked);
      const rows = head.measured
        ? [["strong " + kind, Number.isFinite(d) ? `${signed(d, 4)} mm` : "\u2013"], [kind, words]]
        : [["strong", id]];
      head.scalars.forEach((scale, i) => {
        rows.push(["", `${scale.name} ${fixed(value(scalars[i]), 5)} ${scale.unit}`]);
      });
      const at = world.worldToLocal(hit.point.clone());
      rows.push(["faint", `${id}  x ${fixed(at.x, 2)}  y ${fixed(at.y, 2)}  z ${fixed(at.z, 2)} mm`]);
      tip.replaceChildren(...rows.map(([cls, text]) => {
        const row = document.createElement("div");
        row.className = cls;
        row.textContent = text;
        return row;
      }));
      tip.hidden = false;
      const frame = box.getBoundingClientRect();
      const left = pointer.clientX - frame.left;
      const top = pointer.clientY - frame.top;
      const flip = left + tip.offsetWidth + 24 > frame.width;
      tip.style.left = `${flip ? Math.max(left - tip.offsetWidth - 14, 4) : left + 16}px`;
      tip.style.top = `${Math.min(top + 14, frame.height - tip.offsetHeight - 6)}px`;
      mark(at);
      needle(shownScale === head.deviation ? d : shownScale ? value(scalars[head.scalars.indexOf(shownScale)]) : NaN);
    }
    function hideTip() {
      if (tip.hidden && !marker.visible) return;
      tip.hidden = true;
      marker.visible = markerRim.visible = false;
      needle(null);
      redraw();
    }
    function mark(point) {
      marker.visible = markerRim.visible = true;
      marker.position.copy(point);
      markerRim.position.copy(point);
      redraw();
    }

    // A click, which is no drag, copies the id of the face under it.
    let pressed = null;
    renderer.domElement.addEventListener("pointerdown", (event) => { pressed = [event.clientX, event.clientY]; });
    renderer.domElement.addEventListener("click", (event) => {
      if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4) return;
      const area = renderer.domElement.getBoundingClientRect();
      const x = ((event.clientX - area.left) / area.width) * 2 - 1;
      const y = 1 - ((event.clientY - area.top) / area.height) * 2;
      raycaster.setFromCamera(new THREE.Vector2(x, y), camera);
      const hit = raycaster.intersectObjects(part.children, false)[0];
      if (!hit) return;
      const { id } = hit.object.userData;
      box.dataset.copied = id;
      navigator.clipboard?.writeText(id).catch(() => {});
      $("hover").hidden = false;
      $("hover").textContent = `${id} copied`;
    });

    let picking = false;
    renderer.domElement.addEventListener("pointermove", (event) => {
      pointer = event.buttons === 0 || event.pointerType === "touch" ? event : null;
      if (picking) return;
      picking = true;
      requestAnimationFrame(() => {
        picking = false;
        pick();
      });
    });
    renderer.domElement.addEventListener("pointerdown", (event) => {
      if (event.pointerType === "touch") return;
      pointer = null;
      hideTip();
    });
    renderer.domElement.addEventListener("pointerleave", () => {
      pointer = null;
      hideTip();
    });

    // ---- views ----------------------------------------------------------------------------------------------------

    // The direction is from the part to the viewer; from above a trace of -y keeps x to the right.
    const directions = {
      iso: head.opening,
      top: [0, -1e-5, 1],
      front: [0, -1, 0],
      right: [1, 0, 0],
    };

    function cornersOf({ min, max }) {
      const out = [];
      for (const x of [min.x, max.x]) for (const y of [min.y, max.y]) for (const z of [min.z, max.z]) out.push(new THREE.Vector3(x, y, z));
      return out;
    }

    // What the view has room for: the part, and the machine where it is shown.
    function shown() {
      const all = new THREE.Box3();
      for (const corner of cornersOf({ min: lo, max: hi })) all.expandByPoint(inWorld(corner));
      if (bodies.visible) all.expandByObject(bodies);
      return all;
    }
    let span = null;
    function measure() {
      const all = shown();
      const centre = all.min.clone().add(all.max).multiplyScalar(0.5);
      span = { all, centre, radius: Math.max(0.5 * all.max.distanceTo(all.min), 1e-3) };
    }

    let fitted = false;

    function fit(direction) {
      fitted = true;
      makeRoom();
      const from = (direction ? new THREE.Vector3(...direction) : camera.position.clone().sub(controls.target)).normalize();
      controls.target.copy(span.centre);
      camera.position.copy(span.centre).addScaledVector(from, 20 * span.radius);
      camera.lookAt(span.centre);
      camera.updateMatrixWorld();
      const inView = cornersOf(span.all).map((c) => c.applyMatrix4(camera.matrixWorldInverse));
      const across = Math.max(...inView.map((c) => Math.abs(c.x)), 1e-6);
      const upward = Math.max(...inView.map((c) => Math.abs(c.y)), 1e-6);
      // The legends at the right take room from the picture.
      const free = (camera.right - camera.left) * (1 - legendRoom() / Math.max(box.clientWidth, 1));
      camera.zoom = 0.88 * Math.min(free / (2 * across), camera.top / upward);
      camera.updateProjectionMatrix();
      controls.update();
      redraw();
    }

    // The middle of the picture is the middle of what the legends leave free.
    function makeRoom() {
      const [width, height] = [Math.max(box.clientWidth, 1), Math.max(box.clientHeight, 1)];
      camera.setViewOffset(width, height, 0.5 * legendRoom(), 0, width, height);
    }

    const legendRoom = () => document.querySelector(".legends").offsetWidth + 8;

    // The outward normal of the part where it is nearest to a point.
    function normalAt(point) {
      let nearest = Infinity;
      const normal = new THREE.Vector3(0, 0, 1);
      for (const mesh of part.children) {
        const at = mesh.geometry.getAttribute("position").array;
        for (let i = 0; i < at.length; i += 3) {
          const d = (at[i] - point.x) ** 2 + (at[i + 1] - point.y) ** 2 + (at[i + 2] - point.z) ** 2;
          if (d >= nearest) continue;
          nearest = d;
          normal.fromArray(mesh.geometry.getAttribute("normal").array, i);
        }
      }
      return normal.normalize();
    }

    // Does something stand between a point and a viewer in a direction?
    function covered(point, direction, things) {
      raycaster.set(point.clone().addScaledVector(direction, 1e-3 * radius), direction);
      return raycaster.intersectObjects(things, true).length > 0;
    }

    // From where a place on the surface is seen best: not through the part, and past the tool where that can be; as near
    // to the side that is looked from now as possible.
    function outlook(place) {
      const normal = normalAt(place).transformDirection(world.matrix);
      const point = inWorld(place);
      const now = camera.position.clone().sub(controls.target).normalize();
      const side = new THREE.Vector3().crossVectors(normal, Math.abs(normal.z) < 0.9 ? camera.up : new THREE.Vector3(1, 0, 0)).normalize();
      const other = new THREE.Vector3().crossVectors(normal, side);
      const ways = [];
      for (const lean of [0.35, 0.7, 0.1, 1.0, 1.25]) {
        for (let k = 0; k < 8; k++) {
          const turn = (Math.PI * k) / 4;
          const way = normal.clone().multiplyScalar(Math.cos(lean));
          way.addScaledVector(side, Math.sin(lean) * Math.cos(turn)).addScaledVector(other, Math.sin(lean) * Math.sin(turn));
          ways.push(way.normalize());
        }
      }
      ways.sort((a, b) => b.dot(now) + 0.6 * b.dot(normal) - a.dot(now) - 0.6 * a.dot(normal));
      const inSight = ways.filter((way) => !covered(point, way, part.children));
      const inHandNow = inHand.filter((one) => one.visible);
      const free = tool.visible ? inSight.find((way) => !covered(point, way, inHandNow)) : inSight[0];
      box.dataset.seen = String(inSight.length > 0);
      seeThrough(!free);
      return free || inSight[0] || normal;
    }

    // Shows a place with the tool as it made it.
    function goTo(at, pose) {
      fitted = false;
      const place = new THREE.Vector3(...at);
      let reach = 0.1 * radius;
      if (pose !== null && head.poses.count > 0) {
        play(false);
        slider.value = pose;
        showPose(pose);
        tool.updateMatrixWorld(true);
        const which = poses[perPose * pose + 8];
        const widest = Math.max(...(head.tools[which]?.pieces[0]?.outline ?? []).map(([r]) => r), 0);
        reach = Math.max(reach, 5 * widest);
      }
      const from = outlook(place);
      const target = inWorld(place);
      controls.target.copy(target);
      camera.position.copy(target).addScaledVector(from, 20 * span.radius);
      camera.lookAt(target);
      camera.zoom = camera.top / Math.min(reach, 0.5 * radius);
      camera.updateProjectionMatrix();
      controls.update();
      mark(place);
    }

    function resize() {
      const width = Math.max(box.clientWidth, 1);
      const height = Math.max(box.clientHeight, 1);
      renderer.setSize(width, height, false);
      const aspect = width / height;
      measure();
      camera.top = span.radius;
      camera.bottom = -span.radius;
      camera.right = span.radius * aspect;
      camera.left = -camera.right;
      camera.near = 0.01 * span.radius;
      camera.far = 40 * span.radius;
      makeRoom();
      camera.updateProjectionMatrix();
      for (const material of [lineMaterial, ...linkMaterials]) if (material) material.resolution.set(width, height);
      // What filled the old size fills the new one, until somebody has chosen a detail.
      if (fitted) fit();
      // At once: a new size empties the picture, and waiting a frame would show that.
      draw();
    }

    // ---- furniture ------------------------------------------------------------------------------------------------

    function scaleBar() {
      const mmPerPixel = (camera.top - camera.bottom) / camera.zoom / Math.max(box.clientHeight, 1);
      const wish = 90 * mmPerPixel;
      const decade = Math.pow(10, Math.floor(Math.log10(wish)));
      const length = [5, 2, 1].map((m) => m * decade).find((l) => l <= wish) || decade;
      $("scale-bar").style.width = `${length / mmPerPixel}px`;
      $("scale-bar").textContent = `${Number(length.toPrecision(1))} mm`;
    }

    function triad() {
      for (const [name, v] of [["x", [1, 0, 0]], ["y", [0, 1, 0]], ["z", [0, 0, 1]]]) {
        const p = new THREE.Vector3(...v).applyQuaternion(camera.quaternion.clone().invert());
        const line = $(`axis-${name}`);
        line.setAttribute("d", `M0 0L${(24 * p.x).toFixed(1)} ${(-24 * p.y).toFixed(1)}`);
        const label = $(`axis-${name}-label`);
        label.setAttribute("x", (31 * p.x).toFixed(1));
        label.setAttribute("y", (-31 * p.y + 3.5).toFixed(1));
      }
    }

    let wanted = false;
    function redraw() {
      if (wanted) return;
      wanted = true;
      requestAnimationFrame(draw);
    }
    function draw() {
      wanted = false;
      const toward = camera.position.clone().sub(controls.target).normalize();
      overlay.position.copy(toward).transformDirection(world.matrix.clone().invert()).multiplyScalar(lift);
      const up = new THREE.Vector3(0, 1, 0).applyQuaternion(camera.quaternion);
      const right = new THREE.Vector3(1, 0, 0).applyQuaternion(camera.quaternion);
      lamp.position.copy(controls.target).addScaledVector(toward, 10).addScaledVector(up, 4).addScaledVector(right, -3);
      lamp.target.position.copy(controls.target);
      const pixel = (camera.top - camera.bottom) / camera.zoom / Math.max(box.clientHeight, 1);
      marker.scale.setScalar(3 * pixel);
      markerRim.scale.setScalar(4.5 * pixel);
      renderer.render(scene, camera);
      scaleBar();
      triad();
    }

    function theme() {
      scene.background = new THREE.Color(css("--view"));
      partMaterial.color.set(css("--metal"));
      borderMaterial.color.set(css("--border-line"));
      colourPath(document.querySelector("[name=path]:checked").value);
      redraw();
    }

    // ---- wiring ---------------------------------------------------------------------------------------------------

    for (const input of document.querySelectorAll("[name=part]")) input.addEventListener("change", () => colourPart(input.value));
    for (const input of document.querySelectorAll("[name=path]")) input.addEventListener("change", () => colourPath(input.value));
    $("show-links").addEventListener("change", (e) => { links.visible = e.target.checked; redraw(); });
    $("show-tool").addEventListener("change", (e) => { tool.visible = e.target.checked; redraw(); });
    $("show-machine").addEventListener("change", (e) => showMachine(e.target.checked));
    $("show-borders").addEventListener("change", (e) => { borders.visible = e.target.checked; redraw(); });
    $("so-far").addEventListener("change", () => { limitPath(); redraw(); });
    slider.addEventListener("input", () => { play(false); seeThrough(false); showPose(Number(slider.value)); });
    $("play").addEventListener("click", () => play(!playing));
    for (const button of document.querySelectorAll("[data-view]")) {
      button.addEventListener("click", () => fit(directions[button.dataset.view]));
    }
    for (const button of document.querySelectorAll("[data-at]")) {
      button.addEventListener("click", () => {
        goTo(button.dataset.at.split(" ").map(Number), "pose" in button.dataset ? Number(button.dataset.pose) : null);
        box.scrollIntoView({ block: "nearest" });
      });
    }
    controls.addEventListener("change", redraw);
    controls.addEventListener("start", () => { fitted = false; });
    new ResizeObserver(resize).observe(box);
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", theme);
    document.addEventListener("osculate-theme", theme);

    document.body.classList.add("live");
    resize();
    theme();
    colourPart(document.querySelector("[name=part]:checked").value);
    tool.visible = $("show-tool").checked;
    slider.max = Math.max(head.poses.count - 1, 0);
    slider.value = Math.round(0.62 * Number(slider.max));
    showPose(Number(slider.value));
    fit(directions.iso);
    draw();
    performance.mark("osculate-drawn");
  }

  // ---- page -------------------------------------------------------------------------------------------------------

  $("theme").addEventListener("click", () => {
    const root = document.documentElement;
    const dark = root.dataset.theme ? root.dataset.theme === "dark" : window.matchMedia("(prefers-color-scheme: dark)").matches;
    root.dataset.theme = dark ? "light" : "dark";
    document.dispatchEvent(new Event("osculate-theme"));
  });

  if (head.empty) {
    $("still-words").textContent = "The report has no part and no path to show.";
    return;
  }
  unpack().then(start).catch((error) => {
    document.body.classList.remove("live");
    box.querySelector("canvas")?.remove();
    $("still-words").textContent = `This browser cannot show the part in 3D (${error.message}); here is a still picture.`;
  });
})();
