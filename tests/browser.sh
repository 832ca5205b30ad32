#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: browser.sh PAGE.html
# Opens the page of a report in headless Chromium, through chromedriver, clicks and looks. Ends with 0: all is as it
# should be; 1: it is not, with what is wrong on standard error; 77: no browser, no driver or no curl is installed.
# Where axe-core and html-validate are installed (`make page-tools`, or npm's global packages), they must find nothing.
set -eu

[ $# -eq 1 ] || { echo 'usage: browser.sh PAGE.html' >&2; exit 2; }
[ -r "$1" ] || { echo "browser.sh: cannot read '$1'" >&2; exit 1; }
page=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
browser=$(command -v chromium || command -v google-chrome || command -v chrome) || exit 77
driver=$(command -v chromedriver) || exit 77
command -v curl >/dev/null || exit 77

work=$(mktemp -d)
driver_pid=
session=
clean() {
	[ -z "$session" ] || curl -s -m 10 -X DELETE "$session" >/dev/null || :
	[ -z "$driver_pid" ] || kill "$driver_pid" 2>/dev/null || :
	[ -z "$driver_pid" ] || wait "$driver_pid" 2>/dev/null || :
	rm -rf "$work" 2>/dev/null || { sleep 1; rm -rf "$work"; }
}
trap clean EXIT
trap 'exit 130' INT TERM

fail() {
	echo "browser.sh: $1" >&2
	exit 1
}

# post COMMAND JSON: what the driver answers.
post() {
	curl -sS -m 60 -H 'Content-Type: application/json' -d "$2" "$session/$1" || fail "the driver does not answer to $1"
}

# check WHAT SCRIPT: the script, without double quotes and backslashes, returns '' or what it found instead.
check() {
	answer=$(post execute/sync "{\"script\":\"$2\",\"args\":[]}")
	[ "$answer" = '{"value":""}' ] || fail "$1: $(printf '%s' "$answer" | head -c 600)"
}

# click CSS-SELECTOR: as a user does, with the pointer on the element.
click() {
	element=$(post element "{\"using\":\"css selector\",\"value\":\"$1\"}" |
		sed -n 's/.*"element-[^"]*":"\([^"]*\)".*/\1/p')
	[ -n "$element" ] || fail "nothing to click on: $1"
	answer=$(post "element/$element/click" '{}')
	[ "$answer" = '{"value":null}' ] || fail "cannot click on $1: $answer"
}

# emulate COMMAND JSON: sets what the browser pretends.
emulate() {
	answer=$(post goog/cdp/execute "{\"cmd\":\"Emulation.$1\",\"params\":$2}")
	case $answer in
	*'"error"'*) fail "$1: $answer" ;;
	esac
}

# start: a browser with a new profile.
start() {
	"$driver" --port=0 >"$work/driver" 2>&1 &
	driver_pid=$!
	for _ in $(seq 100); do
		port=$(sed -n 's/.*started successfully on port \([0-9]*\).*/\1/p' "$work/driver")
		[ -z "$port" ] || break
		sleep 0.1
	done
	[ -n "$port" ] || fail "chromedriver does not start: $(head -c 300 "$work/driver")"
	mkdir "$work/profile"
	answer=$(curl -sS -m 60 -H 'Content-Type: application/json' -d '{"capabilities":{"alwaysMatch":{
		"goog:loggingPrefs":{"browser":"ALL","performance":"ALL"},
		"goog:chromeOptions":{"binary":"'"$browser"'","args":["--headless","--no-sandbox","--disable-gpu",
		"--disable-quic","--no-first-run","--disable-background-networking","--disable-component-update",
		"--disable-sync","--window-size=1200,900","--user-data-dir='"$work/profile"'"]}}}}' \
		"http://127.0.0.1:$port/session") || fail 'no session'
	id=$(printf '%s' "$answer" | sed -n 's/.*"sessionId":"\([^"]*\)".*/\1/p')
	[ -n "$id" ] || fail "no session: $(printf '%s' "$answer" | head -c 300)"
	session=http://127.0.0.1:$port/session/$id
}

# modules NAME: where npm has put the package.
modules() {
	for root in "$(dirname "${STDFIT:-build/stdfit}")/npm/node_modules" "$(npm root -g 2>/dev/null || :)"; do
		[ ! -e "$root/$1/package.json" ] || { echo "$root/$1"; return; }
	done
}

# axe WHAT: runs axe-core over the page as it is.
axe() {
	[ -n "$axe" ] || return 0
	answer=$(curl -sS -m 60 -H 'Content-Type: application/json' -d "@$work/axe.json" "$session/execute/async")
	[ "$answer" = '{"value":[]}' ] || fail "axe, $1: $(printf '%s' "$answer" | head -c 600)"
}

axe=$(modules axe-core)
[ -z "$axe" ] || node -e 'const source = require("fs").readFileSync(process.argv[1], "utf8");
	console.log(JSON.stringify({args: [], script: source + ";const done=arguments[0];axe.run().then(r=>done(r.violations" +
	".map(v=>v.id+\": \"+v.nodes.length+\" \"+v.nodes[0].html.slice(0,200))))"}))' "$axe/axe.min.js" >"$work/axe.json"
validate=$(modules html-validate)
if [ -n "$validate" ]; then
	echo '{"root": true, "extends": ["html-validate:recommended"]}' >"$work/rules.json"
	sed 's/base64,[A-Za-z0-9+/=]*/base64,AA==/g' "$page" >"$work/page.html"
	node "$validate/bin/html-validate.mjs" --config "$work/rules.json" "$work/page.html" >"$work/found" 2>&1 ||
		fail "html-validate: $(head -c 900 "$work/found")"
fi

start
post url "{\"url\":\"file://$page\"}" >/dev/null

# What the scripts share: the columns of the table of materials, one of which counts its rows.
rows="const rows=[...document.querySelectorAll('table.sortable tbody tr')];\
const column=i=>rows.map(row=>row.cells[i].dataset.v??row.cells[i].textContent);\
const sorted=(v,sign)=>v.every((x,i)=>!i||sign*(v[i-1]-x)<=0);\
const heads=[...document.querySelectorAll('table.sortable th[scope=col]')];"

check 'materials are in order at first' "$rows const v=column(0);\
return rows.length>1&&v.every((x,i)=>!i||v[i-1]<=x)&&heads[0].ariaSort==='ascending'?'':v.join()"
click 'table.sortable thead th:nth-child(3) button'
check 'a click on the third head sorts by it' "$rows const v=column(2);\
return sorted(v,1)&&heads[2].ariaSort==='ascending'&&!heads[0].ariaSort?'':v.join()"
click 'table.sortable thead th:nth-child(3) button'
check 'a second click sorts the other way round' "$rows const v=column(2);\
return sorted(v,-1)&&heads[2].ariaSort==='descending'?'':v.join()"
check 'a cell is emptied' "$rows rows[0].cells[2].dataset.v='';return ''"
for order in ascending descending; do
	click 'table.sortable thead th:nth-child(3) button'
	check "what is empty stands below all that is $order" "$rows const v=column(2);\
return heads[2].ariaSort==='$order'&&v.indexOf('')===v.length-1?'':v.join()"
done
click 'table.sortable thead th:first-child button'
check 'names sort as names' "$rows const v=column(0);return v.every((x,i)=>!i||v[i-1].localeCompare(x)<=0)?'':v.join()"

check 'details are closed at first' "return document.querySelector('details[open]')?'one is open':''"
click 'details.material:last-of-type summary'
check 'a click on a summary opens it' "const all=document.querySelectorAll('details.material');\
return all[all.length-1].open&&document.querySelectorAll('details[open]').length===1?'':'it is closed'"
click 'table.sortable tbody tr:first-child a'
check 'a link opens its material' "const a=document.querySelector('table.sortable tbody a');\
const d=document.getElementById(a.hash.slice(1));\
const top=d.getBoundingClientRect().top;return d.open&&top>=-2&&top<innerHeight?'':'open: '+d.open+', at '+top"

# Pictures are decoded when they come into view.
check 'all pictures are there' "document.querySelectorAll('details').forEach(d=>d.open=true);\
document.querySelectorAll('img').forEach(i=>i.loading='eager');return ''"
for _ in 1 2 3 4 5 6 7 8 9 10; do
	answer=$(post execute/sync "{\"script\":\"return [...document.images].every(i=>i.complete)\",\"args\":[]}")
	[ "$answer" != '{"value":true}' ] || break
	sleep 0.3
done
check 'all pictures are there' "const bad=[...document.images].filter(i=>!i.complete||!i.naturalWidth||!i.alt\
||!i.src.startsWith('data:image/'));return bad.length?bad.length+' are not, or have no text':''"
check 'spheres are as wide as the column, and of 256 pixels at least' "\
const all=[...document.querySelectorAll('.spheres')];\
const bad=all.find(e=>{const rows=[...e.children].filter(i=>i.offsetTop===e.children[0].offsetTop);\
const width=rows.reduce((sum,i)=>sum+i.clientWidth,0);\
return [...e.children].some(i=>i.clientWidth<250)||width<0.97*e.parentElement.clientWidth});\
return bad?bad.clientWidth+': '+[...bad.children].map(i=>i.clientWidth).join():''"
check 'a button copies the parameters' "window.copied='';\
Object.defineProperty(navigator,'clipboard',{value:{writeText:async t=>{window.copied=t}},configurable:true});\
return document.querySelector('tr[data-options] button.copy')?'':'there is none'"
click 'details.material tr[data-options] button.copy'
check 'a button copies the parameters' "const t=document.querySelector('tr[data-options]').dataset.options;\
return window.copied===t&&t.startsWith('--ndf ')?'':window.copied"
check 'headers head their tables' "const bad=[...document.querySelectorAll('table')].filter(t=>!t.tHead\
||[...t.tHead.rows[0].cells].some(c=>c.tagName!=='TH'||c.scope!=='col')\
||[...t.tBodies[0].rows].some(r=>r.cells.length!==t.tHead.rows[0].cells.length||r.cells[0].scope!=='row'));\
return bad.length?bad[0].className:''"
check 'names are text' "return document.querySelectorAll('h3 *,td :not(span.range),i').length?'markup in a name':''"

# Of text and what lies behind it, by WCAG 2; the colours of a theme differ from those of the other.
contrast="const part=c=>{c/=255;return c<=0.04045?c/12.92:((c+0.055)/1.055)**2.4};\
const light=c=>{const [r,g,b]=c.match(/[0-9]+/g).map(part);return 0.2126*r+0.7152*g+0.0722*b};\
const behind=e=>{for(;e;e=e.parentElement){const c=getComputedStyle(e).backgroundColor;\
if(c!=='rgba(0, 0, 0, 0)')return c}return 'rgb(255, 255, 255)'};\
const ratio=e=>{const a=light(getComputedStyle(e).color),b=light(behind(e));\
return (Math.max(a,b)+0.05)/(Math.min(a,b)+0.05)};\
const low=[...document.querySelectorAll('p,th,td,a,button,summary,span,dt,dd,figcaption')].filter(e=>ratio(e)<4.5);"
for theme in light dark; do
	emulate setEmulatedMedia "{\"features\":[{\"name\":\"prefers-color-scheme\",\"value\":\"$theme\"}]}"
	axe "in $theme colours"
	check "text can be read in $theme colours" "${contrast}\
const paper=light(behind(document.body));if(low.length)return low[0].tagName+' '+ratio(low[0]);\
return ('$theme'==='dark')===(paper<0.1)?'':'the paper has '+paper"
done
check 'plots are turned over in the dark' "const i=document.querySelector('img.plot');\
return !i||getComputedStyle(i).filter.startsWith('invert')?'':getComputedStyle(i).filter"

for width in 360 320; do
	emulate setDeviceMetricsOverride "{\"width\":$width,\"height\":740,\"deviceScaleFactor\":2,\"mobile\":true}"
	axe "at $width pixels"
	check "pictures shrink to $width pixels" "const bad=[...document.images].filter(i=>i.clientWidth>$width);\
return bad.length?bad.length+' do not':''"
	check "nothing sticks out of $width pixels" "const w=document.documentElement.scrollWidth;\
if(innerWidth!==$width||w>$width)return innerWidth+': '+w;\
const out=[...document.querySelectorAll('body *')].filter(e=>!e.closest('.wide table')&&\
e.getBoundingClientRect().right>$width+1);return out.length?out[0].outerHTML.slice(0,200):''"
done

# Nothing but the file itself and what it holds was asked for, and nothing went wrong.
# (The browser's own first page is none of ours.)
requests=$(post se/log '{"type":"performance"}' | sed 's/{"level"/\n&/g' | grep Network.requestWillBeSent |
	grep -F 'documentURL\":\"file:' || :)
printf '%s' "$requests" | grep -qF 'url\":\"data:image/png' || fail 'no log of requests'
urls=$(printf '%s' "$requests" | grep -oE 'url\\":\\"[a-z]+:' | sort -u | grep -vE '"(file|data):$' || :)
[ -z "$urls" ] || fail "the page asks for $urls"
answer=$(post se/log '{"type":"browser"}')
[ "$answer" = '{"value":[]}' ] || fail "the console says $(printf '%s' "$answer" | head -c 300)"

# Without scripts: the same page, sorted, no buttons; a summary opens by itself.
emulate setScriptExecutionDisabled '{"value":true}'
post refresh '{}' >/dev/null
answer=$(post elements '{"using":"css selector","value":"table.sortable button"}')
[ "$answer" = '{"value":[]}' ] || fail "buttons without scripts: $answer"
answer=$(post elements '{"using":"css selector","value":"table.sortable tbody tr"}')
[ "$answer" != '{"value":[]}' ] || fail 'no table without scripts'
click 'details.material summary'
answer=$(post elements '{"using":"css selector","value":"details[open]"}')
[ "$answer" != '{"value":[]}' ] || fail 'a summary does not open without scripts'
